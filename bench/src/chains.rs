//! The paper's cost figure: time per step against the number of equations of a chain.

use std::hint::black_box;
use std::time::Instant;

use eclss_core::Method;

use crate::floor::Floor;
use crate::newton::DenseNewton;
use crate::runner::still_trusted;
use crate::turns::{Contender, Frames, frames, take};
use crate::{Description, Failure, Progress, Runner};

/// The sizes of the paper's figure.
pub const PAPER_SIZES: [usize; 11] = [100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1100];

/// Step of every method [µs].
pub(crate) const STEP_US: u32 = 1_000;
/// Turns of every contender that keeps up with real time.
const TURNS: usize = 101;
/// Frames of the valve scenario: 100 ms open, 1 s of closing, 100 ms after.
pub(crate) const FRAMES: usize = 1_200;
/// How often the scenario is repeated.
pub(crate) const REPEATS: usize = 5;
/// Methods of the core for which a chain of one line is a task; `adaptive` combines it into one flow.
const METHODS: [Method; 4] = [Method::Euler, Method::Relaxation, Method::ImplicitEuler, Method::TrBdf2];

/// What one method costs on one chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Equations of the chain as the paper counts them: n − 1 pressures and one flow.
    pub n: usize,
    /// Name of the method: those of the core, `floor`, `dense-newton`, `bdf`.
    pub method: &'static str,
    /// Median time per step [ns]; for `bdf`, whose frames differ, the mean.
    pub median_ns: f64,
    /// Mean time per frame of 1 ms over the closing of the valve [ns].
    pub mean_ns: f64,
    /// Longest frame of it that came back in every repeat [ns]: what the method makes long, not the machine.
    pub repeated_ns: f64,
    /// Longest frame of all repeats [ns], interruptions by the operating system and all.
    pub worst_ns: f64,
    /// `median_ns` over the floor's of the same run [1].
    pub ratio_to_floor: f64,
}

/// Measures every method on chains of these `sizes` (≥ 2 each) and returns rows by size, then by method.
///
/// The floor and the methods of the core take turns; their ratios are medians over turns. The dense Newton step
/// and BDF, which are thousands of times slower, follow with as many steps as they need.
pub fn chain_costs(sizes: &[usize], progress: &mut dyn FnMut(Progress)) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (done, &n) in sizes.iter().enumerate() {
        progress(Progress { done, total: sizes.len(), equations: n });
        let floor_ns = core_rows(n, &mut rows)?;
        let [newton_ns, newton_slowest_ns] = dense_newton_ns(n)?;
        let ratio_to_floor = newton_ns / floor_ns;
        rows.push(Row {
            n,
            method: "dense-newton",
            median_ns: newton_ns,
            mean_ns: newton_ns,
            repeated_ns: newton_ns,
            worst_ns: newton_slowest_ns,
            ratio_to_floor,
        });
        #[cfg(feature = "peers")]
        {
            let Frames { mean_ns, repeated_ns, worst_ns } = crate::peer::bdf_frames(n)?;
            let ratio_to_floor = mean_ns / floor_ns;
            rows.push(Row {
                n,
                method: "bdf",
                median_ns: mean_ns,
                mean_ns,
                repeated_ns,
                worst_ns,
                ratio_to_floor,
            });
        }
    }
    progress(Progress { done: sizes.len(), total: sizes.len(), equations: 0 });
    Ok(rows)
}

/// Floor and methods of the core on a chain of `n`. Returns the floor's time [ns].
fn core_rows(n: usize, rows: &mut Vec<Row>) -> Result<f64, Failure> {
    let description = Description::paper_chain(n);
    let network = description.network();
    let mut floor = Floor::new(n);
    let mut runners = METHODS.map(|method| Runner::new(&network, method));
    let mut simulators = Vec::new();
    for (method, runner) in METHODS.into_iter().zip(&mut runners) {
        simulators.push(runner.simulator(&network, method, STEP_US)?);
    }
    let mut contenders = vec![Contender::new(|calls| (0..calls).for_each(|_| floor.run()))];
    contenders.extend(simulators.iter_mut().map(|simulator| {
        Contender::new(move |calls| {
            for _ in 0..calls {
                black_box(simulator.step());
            }
        })
    }));
    take(&mut contenders, TURNS);
    let medians: Vec<(f64, f64)> = contenders
        .iter()
        .map(|contender| (contender.median_ns(), contender.ratio_to(&contenders[0])))
        .collect();
    drop(contenders);
    simulators.iter().try_for_each(still_trusted)?;
    drop(simulators);

    let floor_ns = medians[0].0;
    let Frames { mean_ns, repeated_ns, worst_ns } = frames(REPEATS, |frame| {
        (0..FRAMES).for_each(|_| frame(timed(|| floor.run())));
        Ok::<(), Failure>(())
    })?;
    rows.push(Row {
        n,
        method: "floor",
        median_ns: floor_ns,
        mean_ns,
        repeated_ns,
        worst_ns,
        ratio_to_floor: 1.0,
    });
    for ((method, runner), (median_ns, ratio_to_floor)) in
        METHODS.into_iter().zip(&mut runners).zip(medians.into_iter().skip(1))
    {
        let Frames { mean_ns, repeated_ns, worst_ns } = frames(REPEATS, |frame| {
            let mut simulator = runner.simulator(&network, method, STEP_US)?;
            for _ in 0..FRAMES {
                frame(timed(|| {
                    black_box(simulator.step());
                }));
            }
            still_trusted(&simulator)
        })?;
        rows.push(Row {
            n,
            method: method.name(),
            median_ns,
            mean_ns,
            repeated_ns,
            worst_ns,
            ratio_to_floor,
        });
    }
    Ok(floor_ns)
}

/// Fastest and slowest of a few dense Newton steps [ns]; they all do the same.
fn dense_newton_ns(n: usize) -> Result<[f64; 2], Failure> {
    let mut newton = DenseNewton::new(n, 0.08);
    let (mut fastest, mut slowest) = (f64::INFINITY, 0.0f64);
    for _ in 0..REPEATS {
        let mut solved = None;
        let step_ns = timed(|| solved = black_box(newton.step(f64::from(STEP_US) * 1e-6)));
        (fastest, slowest) = (fastest.min(step_ns), slowest.max(step_ns));
        if !solved.is_some_and(f64::is_finite) {
            return Err(Failure::Faulted("dense-newton"));
        }
    }
    Ok([fastest, slowest])
}

/// Time that `work` takes [ns].
pub(crate) fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e9
}
