//! The live page in a real browser: it loads and keeps up, moves the plant, shows malfunctions, comes back, asks
//! nobody else, and nothing in it overlaps.

mod access;
mod choices;
mod climate;
mod driver;
mod plant;
mod slowdown;

use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use driver::Browser;
use eclss_network_file::generate::{Shape, generate};
use plant::Plant;

/// Frames shown so far.
const FRAMES: &str = "return Number(document.documentElement.dataset.frames || 0)";
/// Key codes of the `WebDriver` protocol.
const HOME: &str = "\u{E011}";

fn opened(network: &str) -> (Plant, Browser) {
    let plant = Plant::start(network, 0);
    let browser = Browser::start(1440, 1000);
    browser.open(&plant.link);
    browser.wait("frames arrive", "return Number(document.documentElement.dataset.frames || 0) > 3");
    (plant, browser)
}

#[track_caller]
fn assert_quiet(browser: &Browser) {
    let said = browser.console();
    assert!(said.is_empty(), "the console says {said:#?}");
}

#[test]
fn it_loads_keeps_up_and_asks_nobody_else() {
    let (plant, browser) = opened("station.toml");
    let before = browser.run(FRAMES).as_u64().unwrap();
    sleep(Duration::from_secs(4));
    let rate = (browser.run(FRAMES).as_u64().unwrap() - before) as f64 / 4.0;
    println!("{rate:.1} updates/s");
    assert!(rate >= 10.0, "{rate} updates/s");
    browser.run("document.querySelector('#all details').open = true");
    browser.wait(
        "the table is filled",
        "return document.querySelector('#table td').textContent.endsWith('Pa gauge')",
    );
    assert_quiet(&browser);
    let requests = browser.requests();
    assert!(requests.len() > 8, "the log of requests works: {requests:?}");
    for link in requests {
        assert!(link.starts_with(&plant.link) || link.starts_with("data:"), "asked {link}");
    }
}

#[test]
fn a_slider_moves_the_plant_and_the_drawing() {
    let (plant, browser) = opened("paper.toml");
    // In the file the valve follows a schedule; by hand it does not.
    browser.wait("the slider is held", "return document.querySelector('#input-1').disabled");
    browser.press("#scenario", "by");
    browser.wait("the slider is free", "return !document.querySelector('#input-1').disabled");
    browser.press("#speed", "× 10");
    browser.wait(
        "the loop settles",
        "return Math.abs(parseFloat(document.querySelector('#l0f').textContent) - 86.48) < 0.06",
    );
    plant.wait("loop.mass_flow", "86.5 g/s", |flow| (flow - 0.0865).abs() < 5e-4);
    // Those that would lie under a symbol are left out: five to eight are left, by where they are on their way.
    browser.wait(
        "four to nine arrows are drawn",
        "const count = document.querySelector('#l0a').getAttribute('d').split('M').length - 1; return count >= 4 && count < 10",
    );
    let drawn = browser.run("return document.querySelector('#l0a').getAttribute('d')");
    browser
        .wait("arrows move", &format!("return document.querySelector('#l0a').getAttribute('d') !== {drawn}"));
    // By keyboard alone: all the way to the left.
    browser.press("#input-1", HOME);
    browser.wait("the drawing shows it", "return parseFloat(document.querySelector('#l0f').textContent) < 1");
    plant.wait("valve.opening", "shut", |opening| opening < 1e-6);
    plant.wait("loop.mass_flow", "none", |flow| flow.abs() < 1e-3);
    browser.wait("the valve says so", "return document.querySelector('#e5a').textContent === '0.0 %'");
    assert_quiet(&browser);
}

#[test]
fn a_malfunction_shows_and_is_repaired() {
    let (plant, browser) = opened("station.toml");
    let id = "lab_node1_fan";
    let whole = plant.value("lab_node1.mass_flow");
    browser.click(&format!("button[aria-label='{id}.speed: stops']"));
    browser.wait(
        "it is said",
        "return document.querySelector('#news').textContent.includes('is broken: stops')",
    );
    let broken = format!(
        "return [...document.querySelectorAll('.element.broken')].map(e => e.getAttribute('aria-label')).join() === 'fan {id}'"
    );
    browser.wait("the fan is marked, no other one", &broken);
    browser.wait(
        "the air stands",
        "return parseFloat(document.querySelector('#l0f').textContent.replace('−', '-')) < 40",
    );
    plant.wait(&format!("{id}.speed"), "none", |speed| speed < 1e-6);
    plant.wait("lab_node1.mass_flow", "less than 0.6 of what it was", |flow| flow < 0.6 * whole);
    browser.click(&format!("button[aria-label='{id}.speed: stops']"));
    browser.wait("it is whole again", "return !document.querySelector('.element.broken')");
    browser.wait("the air moves", "return parseFloat(document.querySelector('#l0f').textContent) > 60");
    assert_quiet(&browser);
}

#[test]
fn pause_step_and_units_work_from_the_keyboard() {
    let (plant, browser) = opened("paper.toml");
    browser.press("#pause", " ");
    browser.wait(
        "it is held",
        "return document.querySelector('#pause').getAttribute('aria-pressed') === 'true'",
    );
    // What is shown as held may be a frame older than the plant's last word.
    let tick = plant.still();
    browser.press("#step", "\u{E007}");
    let wait = format!(
        "return [...document.querySelectorAll('#figures dd')].some(cell => cell.textContent === '{}')",
        tick + 1
    );
    browser.wait("one step was taken", &wait);
    assert_eq!(plant.still(), tick + 1);
    browser.press("#units", "mm");
    browser.wait(
        "pressures in mmHg",
        "return /^7[56]\\d\\.\\d\\d mmHg$/.test(document.querySelector('#n0a').textContent)",
    );
    browser.wait("flows in cfm", "return document.querySelector('#l0f').textContent.endsWith('cfm')");
    // A symbol can be reached and chosen without a mouse.
    browser.press("#e1", " ");
    browser.wait(
        "the choice is said",
        "return document.querySelector('#news').textContent.startsWith('fan, mass flow')",
    );
    browser.wait(
        "the choice is marked",
        "return document.querySelector('#e1').getAttribute('aria-pressed') === 'true'",
    );
    // A plant that is held still sends frames, each of them a row.
    browser.click("#record");
    browser.wait("it is recorded", "return parseInt(document.querySelector('#recorded').textContent) >= 1");
    let rows = browser.run("return parseInt(document.querySelector('#recorded').textContent)");
    browser.press("#step", "\u{E007}");
    browser.wait(
        "rows are recorded",
        &format!("return parseInt(document.querySelector('#recorded').textContent) > {rows}"),
    );
    assert_quiet(&browser);
}

#[test]
fn it_comes_back_when_the_server_does() {
    let (plant, browser) = opened("paper.toml");
    let port = plant.port();
    drop(plant);
    browser.wait("the loss is shown", "return document.querySelector('#link').className === 'lost'");
    let before = browser.run(FRAMES).as_u64().unwrap();
    // Another network under the same address: the page takes it up.
    let plant = Plant::start("station.toml", port);
    browser.wait("it is live", "return document.querySelector('#link').className === 'live'");
    browser.wait("the new network is drawn", "return Boolean(document.querySelector('#n9'))");
    browser.wait("frames arrive", &format!("{FRAMES} > 3"));
    assert!(before > 3);
    // While nobody answered, the browser itself says so; the page says nothing else.
    for (level, text) in browser.console() {
        assert!(text.contains("net::ERR"), "{level}: {text}");
    }
    drop(plant);
}

/// Pairs of texts and symbols of the drawing that overlap, and texts that stick out of it, as the browser lays them out.
const OVERLAPS: &str = "
  const sheet = document.querySelector('.schematic');
  const [, , width, height] = sheet.getAttribute('viewBox').split(' ').map(Number);
  const things = [...sheet.querySelectorAll('text')].filter(t => t.textContent).map(t => [t.textContent, t.getBBox()]);
  sheet.querySelectorAll('.symbol').forEach(s => {
    const b = s.getBBox(), m = s.transform.baseVal.consolidate().matrix;
    const [w, h] = [Math.abs(m.a) * b.width, Math.abs(m.d) * b.height];
    things.push([s.parentNode.getAttribute('aria-label'), { x: m.e - w / 2, y: m.f + m.d * b.y, width: w, height: h }]);
  });
  const found = [];
  things.forEach(([a, p], k) => {
    if (p.x < 0 || p.y < 0 || p.x + p.width > width || p.y + p.height > height) found.push(a + ' sticks out');
    things.slice(k + 1).forEach(([b, q]) => {
      // Letters do not fill their boxes to the last pixel.
      if (p.x + 1 < q.x + q.width && q.x + 1 < p.x + p.width && p.y + 3 < q.y + q.height && q.y + 3 < p.y + p.height) {
        found.push(a + ' overlaps ' + b);
      }
    });
  });
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  if (wide > 0) found.push('the page is too wide by ' + wide);
  return found";

/// Whether the first node's pressure is drawn in a unit, which is so once a frame came after the choice.
fn drawn_in(unit: &str) -> String {
    format!("return document.querySelector('#n0a').textContent.endsWith('{unit}')")
}

#[test]
fn pictures_of_loops_stations_and_a_climate_light_and_dark_wide_and_narrow_have_nothing_overlapping() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    std::fs::create_dir_all(&folder).unwrap();
    // Twelve modules, a supply and an exhaust.
    let twelve = folder.join("mesh.toml");
    std::fs::write(&twelve, generate(Shape::Mesh, 14, 1).unwrap().to_toml()).unwrap();
    let twelve = twelve.display().to_string();
    for network in ["paper.toml", "station.toml", "thcs.toml", "hil.toml", &twelve] {
        let (plant, browser) = opened(network);
        if network == "paper.toml" {
            browser.press("#scenario", "by");
        }
        browser.press("#speed", "× 10");
        sleep(Duration::from_secs(3));
        for (scheme, width) in [("light", 1440), ("dark", 1440), ("light", 800)] {
            browser.prefer(scheme);
            browser.devtools(
                "Emulation.setDeviceMetricsOverride",
                &serde_json::json!({"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": false}),
            );
            for units in ["kPa", "mmHg"] {
                browser.choose("#units", units);
                browser.wait(units, &drawn_in(units));
                sleep(Duration::from_millis(400));
                let found = browser.run(OVERLAPS);
                assert_eq!(found, serde_json::json!([]), "{network}, {scheme}, {width} px, {units}");
            }
            browser.choose("#units", "kPa");
            browser.wait("kPa", &drawn_in("kPa"));
            sleep(Duration::from_millis(400));
            let name = Path::new(network).file_stem().unwrap().display();
            let path = folder.join(format!("{name}_{scheme}_{width}.png"));
            let picture = browser.picture();
            assert!(picture.len() > 20_000, "a picture of something");
            std::fs::write(&path, picture).unwrap();
            println!("{}", path.display());
        }
        assert_quiet(&browser);
        drop(plant);
    }
}

#[test]
fn the_report_opens_from_disk_and_asks_nobody() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("report.html");
    let made = std::process::Command::new(env!("CARGO_BIN_EXE_eclss-rt"))
        .args(["report", "--sizes", "20,40", "--hours", "1", "-o"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(made.status.success(), "{made:?}");
    let browser = Browser::start(1280, 900);
    browser.open(&format!("file://{}", file.display()));
    let shown = browser.run(
        "return [...document.querySelectorAll('figure svg')].filter(svg => svg.getBoundingClientRect().height > 50).length",
    );
    assert!(shown.as_u64().is_some_and(|count| count >= 14), "{shown} figures");
    let wide =
        browser.run("return document.documentElement.scrollWidth - document.documentElement.clientWidth");
    assert_eq!(wide, 0, "wider than the window");
    assert_quiet(&browser);
    for link in browser.requests() {
        assert!(link.starts_with("file://"), "asked {link}");
    }
}

/// A loop with hardware shows its mode, what its channels are worth, and its link, on the same page.
#[cfg(feature = "hil")]
#[test]
fn a_loop_with_hardware_shows_mode_channels_and_link() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks/hil.toml");
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_eclss-rt"))
        .args(["hil", "--loopback", "--page", "127.0.0.1:8993", "--duration", "120s", "--network"])
        .arg(file)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let browser = Browser::start(1440, 1000);
    for _ in 0..400 {
        if std::net::TcpStream::connect("127.0.0.1:8993").is_ok() {
            break;
        }
        sleep(Duration::from_millis(50));
    }
    browser.open("http://127.0.0.1:8993/");
    browser.wait("frames arrive", "return Number(document.documentElement.dataset.frames || 0) > 3");
    browser.wait("the mode is shown", "return /ModeRUN/.test(document.querySelector('#loop').textContent)");
    browser.wait("the link is up", "return document.querySelector('#loop').textContent.includes('Linkup')");
    browser.wait(
        "outputs are good",
        "return /loop.mass_flowoutgood0/.test(document.querySelector('#channels').textContent)",
    );
    browser.wait(
        "the command comes first",
        "return [...document.querySelectorAll('#channels tr')].map(row => row.textContent).join().startsWith('valve.opening')",
    );
    assert_quiet(&browser);
    if let Ok(folder) = std::env::var("ECLSS_PICTURES") {
        std::fs::write(Path::new(&folder).join("hil.png"), browser.picture()).unwrap();
    }
    // Our own, by its number.
    run.kill().unwrap();
    run.wait().unwrap();
}
