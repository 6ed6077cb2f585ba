//! Choosing a network, and recording into a file of the server.

use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use super::driver::Browser;
use super::plant::Plant;
use super::{assert_quiet, opened};

#[test]
fn another_network_is_chosen_and_the_page_follows() {
    let (plant, browser) = opened("paper.toml");
    let listed = "return document.querySelectorAll('#network option').length === 7";
    browser.wait("the one asked for and the six that ship are listed", listed);
    for (choice, node, title) in
        [("networks/station", "#n9", "Station"), ("networks/thcs", "#n6", "Temperature")]
    {
        browser.choose("#network", choice);
        browser.wait(
            "it is drawn",
            &format!(
                "return Boolean(document.querySelector('{node}')) && document.title.startsWith('{title}')"
            ),
        );
        browser.wait("it runs", "return document.querySelector('#link').className === 'live' && document.querySelector('#n0a').textContent.endsWith('kPa')");
    }
    plant.wait("cabin.pressure", "finite", f64::is_finite);
    // A reload finds the same, and the choice shown.
    browser.open(&plant.link);
    browser.wait(
        "the choice is shown",
        "return document.querySelector('#network').selectedOptions[0]?.textContent === 'networks/thcs.toml'",
    );
    for (level, text) in browser.console() {
        assert!(text.contains("net::ERR"), "{level}: {text}");
    }
}

#[test]
fn the_server_records_into_a_named_file_where_that_was_switched_on() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("recordings");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let plant = Plant::with("paper.toml", 0, &["--recordings", &folder.display().to_string()]);
    let browser = Browser::start(1440, 1000);
    browser.open(&plant.link);
    browser.wait("frames arrive", "return Number(document.documentElement.dataset.frames || 0) > 3");
    browser.run("document.querySelector('#file').value = '../escape'");
    browser.press("#record", " ");
    browser.wait(
        "it is refused",
        "return document.querySelector('#news').textContent.includes('letters, digits')",
    );
    browser.run("document.querySelector('#file').value = 'run-7'");
    browser.press("#record", " ");
    browser.wait(
        "rows are written",
        "return /^run-7.csv: \\d\\d+ rows$/.test(document.querySelector('#recorded').textContent)",
    );
    browser.press("#record", " ");
    browser.wait(
        "its end is said",
        "return document.querySelector('#news').textContent.startsWith('run-7.csv is written')",
    );
    let text = std::fs::read_to_string(folder.join("run-7.csv")).unwrap();
    let rows: Vec<_> = text.lines().collect();
    let columns = |row: &str| row.split(',').count();
    assert!(rows.len() > 10 && rows[0].starts_with("t_s,tick,cabin.pressure"), "{}", rows[0]);
    assert!(rows.iter().all(|row| columns(row) == columns(rows[0])));
    sleep(Duration::from_millis(300));
    assert_eq!(std::fs::read_to_string(folder.join("run-7.csv")).unwrap(), text, "it has ended");
    // Not over a file that is there.
    browser.press("#record", " ");
    browser.wait("it is refused", "return document.querySelector('#news').textContent.includes('already')");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    for (level, text) in browser.console() {
        assert!(text.contains("409"), "{level}: {text}");
    }
}

#[test]
fn a_server_without_a_folder_writes_nothing_and_the_page_saves_by_itself() {
    let (plant, browser) = opened("paper.toml");
    let mut answer = ureq::post(format!("{}recording", plant.link))
        .config()
        .http_status_as_error(false)
        .build()
        .header("Content-Type", "application/json")
        .send("{\"file\":\"a\"}")
        .unwrap();
    assert_eq!(answer.status(), 403, "{}", answer.body_mut().read_to_string().unwrap());
    browser.run("document.querySelector('#file').value = 'mine'");
    browser.click("#record");
    browser.wait("rows are kept", "return parseInt(document.querySelector('#recorded').textContent) > 3");
    browser.click("#record");
    browser.wait(
        "it is saved",
        "return document.querySelector('#news').textContent.startsWith('mine.csv is saved')",
    );
    assert_quiet(&browser);
}
