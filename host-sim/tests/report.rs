//! The report is complete in itself, and each figure names the command that makes it.

use std::sync::OnceLock;

use eclss_host_sim::Progress;
use eclss_host_sim::report::{Contents, report};

/// A short one: the same sections with fewer points.
fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        let contents = Contents { sizes: vec![20, 40], ledger_s: 3, day_s: 120, map: (12, 5) };
        report(&contents, &Progress::hidden()).unwrap_or_else(|failure| panic!("{failure}"))
    })
}

/// What stands between two marks, everywhere.
fn between<'p>(page: &'p str, start: &str, end: &str) -> Vec<&'p str> {
    page.split(start).skip(1).map(|rest| rest.split(end).next().unwrap_or_default()).collect()
}

#[test]
fn nothing_is_loaded_from_anywhere() {
    let page = page();
    assert!(page.contains("Content-Security-Policy\" content=\"default-src 'none'"));
    for what in ["<script", "<link", "<img", "<iframe", "<object", "src=", "@import", "url("] {
        assert!(!page.contains(what), "{what}");
    }
    for target in between(page, "href=\"", "\"") {
        assert!(target.starts_with('#') && page.contains(&format!("id=\"{}\"", &target[1..])), "{target}");
    }
    for link in between(page, "http", " ") {
        // Names of the SVG language, and addresses quoted as text; none of them is followed.
        assert!(
            link.starts_with("://www.w3.org/")
                || link.starts_with("s://docs.rs")
                || link.starts_with("-equiv"),
            "{link}"
        );
    }
}

#[test]
fn every_figure_and_every_table_names_its_command() {
    let figures = between(page(), "<figure", "</figure>");
    assert!(figures.len() >= 14, "{} figures", figures.len());
    for figure in figures {
        let command = between(figure, "<code>", "</code>");
        let named =
            command.first().is_some_and(|text| text.starts_with("eclss-rt ") || text.starts_with("cargo "));
        assert!(named, "{}", &figure[figure.len().saturating_sub(400)..]);
        let svg = &figure[figure.find("<svg").expect("a picture")..];
        let svg = &svg[..svg.rfind("</svg>").expect("its end") + 6];
        roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{error}"));
    }
    let tables = between(page(), "<p>Table ", "</p>");
    assert!(tables.len() >= 6 && tables.iter().all(|about| about.contains("<code>")), "{tables:?}");
}

#[test]
fn what_was_promised_is_in_it() {
    for part in [
        "86.4776",
        "4.0456",
        "−0.3412 %",
        "0.99942",
        "Stability maps",
        "Experiment P0",
        "lacks at most",
        "dense-newton",
        "Cortex-M4F",
        "T paper_figures",
        "Gershgorin",
        "networks/station.toml",
        "0 with it",
        "networks/thcs.toml",
        "air at 75 °F, not fitted: largest error",
        "turned over",
        "largest h·c·G",
        "tr-bdf2, linear hold",
        "0.6180",
        "a tick late",
        "chain-1100",
    ] {
        assert!(page().contains(part), "{part}");
    }
    // The condenser where it was not fitted: 36 points, each within the bar of its own test.
    let tables = between(page(), "<table", "</table>");
    let table = tables.iter().find(|table| table.contains(">0.625 / ")).expect("60 °F at 450 cfm");
    let pairs: Vec<(f64, f64)> = between(table, "<td class=\"number\">", "</td>")
        .iter()
        .filter_map(|cell| cell.split_once(" / "))
        .map(|(printed, ours)| (printed.parse().unwrap(), ours.parse().unwrap()))
        .collect();
    assert_eq!(pairs.len(), 36);
    assert!(pairs.iter().all(|(printed, ours)| (ours / printed - 1.0).abs() <= 0.051), "{pairs:?}");
    // The reference of P at 11.1 s, where it runs backward, and an error below the bar beside it.
    let row = between(page(), "<td class=\"number\">11.1 s</td>", "</tr>")[0];
    assert!(row.contains("−3.3856"), "{row}");
    let errors = between(row, "<td class=\"number\">", "</td>");
    let last: f64 = errors.last().unwrap().replace('−', "-").parse().unwrap();
    assert!(last.abs() < 0.03, "{errors:?}");
}
