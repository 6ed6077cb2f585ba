//! For everybody: by keyboard alone, by a screen reader, without movement, with little sight.

use std::collections::BTreeSet;
use std::thread::sleep;
use std::time::Duration;

use serde_json::json;

use super::{assert_quiet, opened};

const TAB: &str = "\u{E004}";

/// Everything that can be used now, by a name for messages.
const USABLE: &str = "
  const name = e => e.id || e.getAttribute('aria-label') || e.textContent;
  const usable = e => !e.disabled && e.checkVisibility() && !e.closest('details:not([open]) > :not(summary)');
  return [...document.querySelectorAll('a[href], button, select, input, summary, [tabindex=\"0\"]')].filter(usable).map(name)";
/// What has the focus, and whether that can be seen.
const FOCUS: &str = "
  const e = document.activeElement;
  if (e === document.body) return null;
  const edge = e.querySelector(':scope > rect, .symbol .body');
  const seen = edge && e.matches('.schematic *') ? getComputedStyle(edge).strokeWidth === '4px' : getComputedStyle(e).outlineStyle !== 'none';
  return [e.id || e.getAttribute('aria-label') || e.textContent, seen]";

#[test]
fn every_control_is_reached_by_the_tab_key_and_its_focus_is_seen() {
    let (_plant, browser) = opened("thcs.toml");
    browser.press("#scenario", "by");
    browser.wait("nothing is scheduled", "return ![...document.querySelectorAll('#inputs span')].some(s => s.textContent.includes('schedule'))");
    let names = |value: serde_json::Value| -> BTreeSet<String> {
        value.as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
    };
    let usable = names(browser.run(USABLE));
    assert!(usable.len() > 50, "{usable:?}");
    browser.run("document.activeElement.blur(); window.scrollTo(0, 0)");
    let mut reached = BTreeSet::new();
    for _ in 0..3 * usable.len() {
        browser.key(TAB);
        let focus = browser.run(FOCUS);
        let Some(pair) = focus.as_array() else { continue };
        let name = pair[0].as_str().unwrap().to_owned();
        assert_eq!(pair[1], true, "the focus on {name} is not seen");
        reached.insert(name);
        if usable.is_subset(&reached) {
            break;
        }
    }
    let missing: Vec<_> = usable.difference(&reached).collect();
    assert!(missing.is_empty(), "never reached: {missing:?}");
    assert_quiet(&browser);
}

#[test]
fn a_screen_reader_finds_a_name_for_everything() {
    let (_plant, browser) = opened("thcs.toml");
    browser.run("document.querySelectorAll('details').forEach(one => { one.open = true; })");
    browser.wait("the table is filled", "return Boolean(document.querySelector('#all td')?.textContent)");
    // Sliders say their value with its unit.
    browser.wait("values are said", "return Boolean(document.querySelector('#inputs input[type=range]').getAttribute('aria-valuetext')?.endsWith(' %'))");
    sleep(Duration::from_millis(1_200));
    browser.devtools("Accessibility.enable", &json!({}));
    let tree = browser.devtools("Accessibility.getFullAXTree", &json!({}));
    let mut seen = 0;
    for node in tree["nodes"].as_array().unwrap() {
        let role = node["role"]["value"].as_str().unwrap_or_default();
        let roles = [
            "button",
            "slider",
            "combobox",
            "textbox",
            "searchbox",
            "spinbutton",
            "image",
            "img",
            "link",
            "table",
            "region",
        ];
        if node["ignored"] == true || !roles.contains(&role) {
            continue;
        }
        let name = node["name"]["value"].as_str().unwrap_or_default();
        assert!(!name.trim().is_empty() || role == "table", "a {role} without a name: {node}");
        seen += 1;
    }
    assert!(seen > 120, "{seen} things");
    // What happens is announced, and there is one main part with headings in it.
    assert_eq!(browser.run("return document.querySelectorAll('main').length === 1 && document.querySelector('#news').getAttribute('aria-live') === 'polite'"), true);
    let headings = browser.run("return [...document.querySelectorAll('section')].every(s => document.getElementById(s.getAttribute('aria-labelledby'))?.textContent)");
    assert_eq!(headings, true, "every section has a heading");
    assert_quiet(&browser);
}

#[test]
fn nothing_moves_for_those_who_asked_for_less_motion() {
    let (_plant, browser) = opened("paper.toml");
    browser.press("#scenario", "by");
    browser.press("#speed", "× 10");
    browser.wait(
        "it settles",
        "return Math.abs(parseFloat(document.querySelector('#l0f').textContent) - 86.48) < 0.02",
    );
    let arrows = || browser.run("return document.querySelector('#l0a').getAttribute('d')");
    let moves = || {
        let before = arrows();
        sleep(Duration::from_millis(700));
        assert!(before.as_str().is_some_and(|path| path.len() > 50), "arrows are drawn: {before}");
        before != arrows()
    };
    // A busy machine may take a while to draw the next picture, and to draw it as it was asked to.
    let soon = |wanted: bool| (0..20).any(|_| moves() == wanted);
    assert!(soon(true), "arrows move where nobody minds");
    browser.prefer_all(&[("prefers-reduced-motion", "reduce")]);
    assert!(soon(false), "arrows stand still");
    assert!(!moves(), "and go on doing so");
    browser.prefer_all(&[("prefers-reduced-motion", "no-preference")]);
    assert!(soon(true), "and move again");
}

/// Pairs of colours with the least contrast that WCAG 2.2 asks for: 4.5 for text, 3 for lines and symbols.
const CONTRAST: &str = "
  const value = text => {
    const probe = document.createElement('i');
    probe.style.color = text;
    document.body.append(probe);
    const [r, g, b] = getComputedStyle(probe).color.match(/[\\d.]+/g).map(Number);
    probe.remove();
    const linear = part => { const c = part / 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
    return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  };
  const ratio = (a, b) => { const [x, y] = [value(a), value(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); };
  const page = getComputedStyle(document.documentElement);
  const sheet = getComputedStyle(document.querySelector('.schematic'));
  const of = (style, name) => { const text = style.getPropertyValue('--' + name).trim(); if (!text) throw new Error(name); return text; };
  const found = [];
  const check = (style, front, backs, least) => backs.forEach(back => {
    const is = ratio(of(style, front), of(style, back));
    if (is < least) found.push(`${front} on ${back}: ${is.toFixed(2)}`);
  });
  for (const front of ['text', 'soft', 'warn', 'bad', 'good']) check(page, front, ['card', 'back'], 4.5);
  for (const front of ['accent', 'c0', 'c1', 'c2', 'c3', 'c4', 'c5']) check(page, front, ['card'], 3);
  const fills = ['sheet', 'cabin', 'liquid', 'held', 'fill'];
  for (const front of ['ink', 'faint']) check(sheet, front, fills, 4.5);
  for (const front of ['line', 'flow', 'bent', 'bad']) check(sheet, front, ['sheet', 'fill'], 3);
  check(sheet, 'bad', ['sheet'], 4.5);
  for (const button of document.querySelectorAll('button[aria-pressed=\"true\"]')) {
    const { color, backgroundColor } = getComputedStyle(button);
    const is = ratio(color, backgroundColor);
    if (is < 4.5) found.push(`${button.textContent}: ${is.toFixed(2)}`);
  }
  return found";

#[test]
fn colours_have_contrast_in_light_and_dark() {
    let (_plant, browser) = opened("station.toml");
    browser.click("button[aria-label='lab_node1_fan.speed: stops']");
    browser.press("#pause", " ");
    browser.wait(
        "both are pressed",
        "return document.querySelectorAll('button[aria-pressed=\"true\"]').length >= 2",
    );
    for scheme in ["light", "dark"] {
        browser.prefer(scheme);
        assert_eq!(browser.run(CONTRAST), json!([]), "{scheme}, as the system");
        browser.press("#theme", scheme);
        browser.prefer(if scheme == "light" { "dark" } else { "light" });
        assert_eq!(browser.run(CONTRAST), json!([]), "{scheme}, chosen");
        browser.press("#theme", "as");
    }
    assert_quiet(&browser);
}
