//! The documents say what the code does.

use std::path::{Path, PathBuf};

use eclss_core::component::FileKind;
use eclss_core::components::KINDS;
use eclss_core::parameter::KeyType;
use eclss_network_file::limits::{self, Range};
use eclss_network_file::{parse, reference};

const REFERENCE: &str = include_str!("../../docs/network-file.md");
const COMPONENTS: &str = include_str!("../../docs/components.md");

#[test]
fn its_example_is_accepted() {
    let start = REFERENCE.find("```toml\n").expect("an example") + "```toml\n".len();
    let example = &REFERENCE[start..];
    let example = &example[..example.find("```").expect("its end")];
    let loaded = parse(example, "network-file.md").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(loaded.records.len(), 3);
}

#[test]
fn the_reference_of_components_is_the_list_of_kinds() {
    let generated = reference::components();
    let mut lines = generated.lines().zip(COMPONENTS.lines()).enumerate();
    let first = lines.find(|(_, (now, written))| now != written);
    assert!(
        generated == COMPONENTS,
        "docs/components.md is not what the kinds say, first at {first:?}; write it anew:\n\
         cargo run --release -- kinds --markdown > docs/components.md"
    );
}

/// A sentence of its own: a capital or a symbol first, a full stop last.
fn is_sentence(text: &str) -> bool {
    text.len() > 2 && text.ends_with('.') && !text.starts_with(|first: char| first.is_ascii_lowercase())
}

/// Returns what the documents of a kind lack.
fn gaps(kind: &dyn FileKind) -> Vec<String> {
    let mut gaps = Vec::new();
    let mut note = |lacks: bool, what: String| gaps.extend(lacks.then(|| format!("{}: {what}", kind.name())));
    note(!is_sentence(kind.about()), "no sentence about it".to_owned());
    for key in kind.keys().iter().copied().flatten() {
        note(!is_sentence(key.about), format!("no sentence about `{}`", key.name));
        match key.holds {
            KeyType::Number { unit, min, max } => {
                note(unit.is_empty(), format!("`{}` without unit", key.name));
                note(min >= max, format!("`{}` without range", key.name));
            }
            KeyType::Choice(words) => note(words.is_empty(), format!("`{}` without words", key.name)),
            KeyType::Flag | KeyType::Component => {}
        }
    }
    for input in kind.inputs() {
        note(input.unit.is_empty(), format!("input `{}` without unit", input.name));
    }
    for output in kind.outputs() {
        note(output.label.is_empty(), format!("output `{}` without meaning", output.name));
    }
    gaps
}

#[test]
fn every_kind_documents_itself() {
    let gaps: Vec<_> = KINDS.iter().flat_map(|kind| gaps(*kind)).collect();
    assert!(gaps.is_empty(), "{}", gaps.join("\n"));
}

#[test]
fn its_ranges_are_the_ones_that_are_checked() {
    let ranges: [(&str, &Range); 12] = [
        ("reference_pressure_pa", &limits::PRESSURE),
        ("volume_m3", &limits::NODE_VOLUME),
        ("pressure_pa", &limits::PRESSURE),
        ("temperature_k", &limits::TEMPERATURE),
        ("laminar_below_pa", &limits::PRESSURE),
        ("initial_flow_kg_s", &limits::MASS_FLOW),
        ("reference_density_kg_m3", &limits::DENSITY),
        ("length_m", &limits::LENGTH),
        ("diameter_m", &limits::DIAMETER),
        ("diameter_m", &limits::AREA),
        ("inertance_per_m", &limits::INERTANCE),
        ("outlet_volume_m3", &limits::OUTLET_VOLUME),
    ];
    for (key, range) in ranges {
        let row = |line: &&str| line.starts_with(&format!("| `{key}`"));
        let written = range.to_string();
        let found = REFERENCE.lines().filter(row).any(|line| line.contains(&written));
        assert!(found, "`{key}` with {written}");
    }
    let limits = format!(
        "{} MiB, {} nodes, {} lines, {} elements, {} schedules, {} schedule points",
        limits::FILE_BYTES >> 20,
        limits::NODES,
        limits::LINES,
        limits::ELEMENTS,
        limits::SCHEDULES,
        limits::SCHEDULE_POINTS
    );
    assert!(REFERENCE.contains(&limits), "{limits}");
}

#[test]
fn they_know_every_key_that_the_files_use() {
    for file in [include_str!("../../networks/paper.toml"), include_str!("files/zoo.toml")] {
        for key in file.lines().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key) {
            let key = format!("`{key}`");
            assert!(REFERENCE.contains(&key) || COMPONENTS.contains(&key), "{key}");
        }
    }
}

/// The repository's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace is around it").to_owned()
}

/// Texts of all documents with their paths.
fn documents() -> Vec<(PathBuf, String)> {
    let folders = [root(), root().join("docs")];
    let entries = folders.iter().flat_map(|folder| folder.read_dir().expect("a folder")).flatten();
    let papers =
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|end| end == "md"));
    papers.map(|path| (path.clone(), std::fs::read_to_string(path).expect("a text"))).collect()
}

/// Names by which the headings of a document are linked.
fn anchors(text: &str) -> Vec<String> {
    let kept = |letter: &char| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_');
    let headings =
        text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    headings
        .map(|heading| heading.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-"))
        .collect()
}

#[test]
fn links_lead_to_files_and_headings() {
    let documents = documents();
    assert!(documents.len() > 10, "{}", documents.len());
    for (path, text) in &documents {
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") || link.is_empty() {
                continue;
            }
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let folder = path.parent().expect("it lies in a folder");
            let goal = if file.is_empty() { path.clone() } else { folder.join(file) };
            assert!(goal.exists(), "{}: {link}", path.display());
            if !heading.is_empty() {
                let goal = std::fs::read_to_string(&goal).expect("a text");
                assert!(anchors(&goal).contains(&heading.to_owned()), "{}: {link}", path.display());
            }
        }
    }
}

#[test]
fn the_functions_of_a_tick_are_where_the_picture_has_them() {
    let picture = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("a text");
    let picture = picture.split("## One tick").nth(1).expect("a section of the tick");
    let mut found = 0;
    for line in
        picture.lines().filter(|line| line.strip_suffix(".rs").is_some_and(|stem| !stem.ends_with('*')))
    {
        let mut words = line.split_whitespace().rev();
        let (Some(file), Some(function)) = (words.next(), words.next()) else { continue };
        let source =
            std::fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        let name = function.rsplit("::").next().unwrap_or(function);
        let here = ["(", "<"].iter().any(|end| source.contains(&format!("fn {name}{end}")));
        assert!(here || source.contains(&format!("struct {name} ")), "{file} has no `{name}`");
        found += 1;
    }
    assert!(found > 10, "{found}");
}
