//! Does an open page slow the plant? The 99th percentile of a step, page closed and open by turns in one run.

use std::thread::sleep;
use std::time::Duration;

use super::FRAMES;
use super::driver::Browser;
use super::plant::Plant;

/// Pairs of blocks, one closed and one open, nine seconds each: what is taken at least, and at most unless
/// `ECLSS_PAIRS` says otherwise.
const FEWEST: usize = 6;
const MOST: usize = 10;
/// What is promised.
const BAR: f64 = 1.05;
/// Standard errors beyond which the promise counts as kept, and as broken: of so few pairs the error itself is uncertain,
/// and a machine that does other work besides must not fail by chance.
const KEPT: f64 = 2.0;
const BROKEN: f64 = 3.0;

/// Median, and its standard error by the median deviation.
fn middle(list: &[f64]) -> (f64, f64) {
    let median = |mut list: Vec<f64>| {
        list.sort_by(f64::total_cmp);
        let half = list.len() / 2;
        if list.len() % 2 == 1 { list[half] } else { 0.5 * (list[half - 1] + list[half]) }
    };
    let centre = median(list.to_vec());
    let deviation = median(list.iter().map(|value| (value - centre).abs()).collect());
    // Of a normal distribution: 1.48 deviations are one σ, and a median is 1.25 times as uncertain as a mean.
    (centre, 1.48 * 1.25 * deviation / (list.len() as f64).sqrt())
}

#[test]
fn an_open_page_does_not_slow_the_plant() {
    // With real-time rights, as a plant with hardware has them, where this build and this machine give them.
    let further: &[&str] = if cfg!(feature = "hil") { &["--real-time"] } else { &[] };
    let plant = Plant::with("station.toml", 0, further);
    let browser = Browser::start(1440, 1000);
    let most =
        std::env::var("ECLSS_PAIRS").map_or(MOST, |pairs| pairs.parse().expect("ECLSS_PAIRS is a number"));
    let mut frames = 0;
    // The plant publishes its figures over windows of two seconds. The first window saw the change, the second counts.
    let mut block = |open: bool| {
        browser.open(if open { &plant.link } else { "about:blank" });
        sleep(Duration::from_millis(4_150));
        let figures = plant.frame()["figures"].clone();
        if open {
            frames += browser.run(FRAMES).as_u64().unwrap();
        }
        let figure = |name: &str| figures[name].as_f64().unwrap();
        (figure("p99_us"), figure("mean_us"))
    };
    let (mut tails, mut means, mut closed_us) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        // Closed first, then open first: a drift of the machine falls on both alike.
        let first_open = tails.len() % 2 == 1;
        let (one, other) = (block(first_open), block(!first_open));
        let (closed, open) = if first_open { (other, one) } else { (one, other) };
        tails.push(open.0 / closed.0);
        means.push(open.1 / closed.1);
        closed_us.push(closed.0);
        let (ratio, error) = middle(&tails);
        let decided = ratio + KEPT * error < BAR || ratio - BROKEN * error >= BAR;
        if tails.len() >= most || (tails.len() >= FEWEST && decided) {
            break;
        }
    }
    let ((tail, error), (mean, mean_error)) = (middle(&tails), middle(&means));
    let percent = |part: f64| part * 100.0;
    println!("open over closed, pair by pair: {tails:.3?}");
    println!(
        "p99 of a step, {:.1} µs closed: {:+.1} % ± {:.1} % in {} pairs; mean {:+.1} % ± {:.1} %; {}",
        middle(&closed_us).0,
        percent(tail - 1.0),
        percent(error),
        tails.len(),
        percent(mean - 1.0),
        percent(mean_error),
        if tail + KEPT * error < BAR { "below 5 %" } else { "this machine cannot tell" },
    );
    assert!(frames as usize > 60 * tails.len(), "the page was live: {frames} frames");
    // A machine that does other work besides cannot tell five per cent; then only what is certain fails.
    assert!(tail - BROKEN * error < BAR, "certainly slower with the page open: {tail:.3} ± {error:.3}");
}
