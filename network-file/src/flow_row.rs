//! Which element of a line carries its flow in method `relaxation`.
//!
//! The method gives every element before that one a pressure row of its own and folds all others into the flow
//! row. The paper has its flow on the valve, the stiffest element when closed. That is taken here too (the valve
//! that resists most when closed, without one the element that resists most), if the step is then stable at
//! every opening looked at. If not, the flow sits on the last element for which the folded resistance never
//! falls below that of the rows, where Gershgorin's theorem proves stability for every step.
//!
//! Stability of a step `h` around a flow: the rows are `z·q_i = q_i + h·(q_{i−1} − q_i − b_i·w)`, the flow row
//! `z·w = w + h·φ·(q_v − A·w)`. With `g = h/(z − 1 + h)` the eigenvalues are the zeros of
//! `D(z) = z − 1 + h·φ·(A + Σ b_i·g^(v−i))`, i from 0, whose poles lie inside the unit circle; all zeros do so
//! too exactly if D turns once around 0 on the way around it (argument principle).

use eclss_core::components::{Fan, Pump, Valve};
use eclss_core::{AnyComponent, Element, Operating, Segment};

/// Longest line for which the paper's choice is examined.
const MOST_SEGMENTS: usize = 200;
/// Openings that are looked at.
const OPENINGS: [f32; 8] = [1.0, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.0];
/// Steps that are looked at, up to the longest of the method [s].
const STEPS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Points on the half circle, spaced by a factor in angle.
const POINTS: i32 = 120;

/// Loss R·w² + L·w − head of one element.
#[derive(Debug, Clone, Copy, Default)]
struct Loss {
    quadratic: f64,
    linear: f64,
    head: f64,
}

/// What is looked at: the elements of a line and how they are driven at the start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Driven<'a> {
    /// The line's segments.
    pub(crate) segments: &'a [Segment],
    /// Pressure difference between the line's ends [Pa].
    pub(crate) drop_pa: f64,
    /// Flow at the start [kg/s].
    pub(crate) start_flow_kg_s: f64,
}

/// Returns the place in the line of the element that carries the flow.
pub(crate) fn choose(line: Driven<'_>) -> usize {
    let preferred = stiffest(line.segments);
    if line.segments.len() <= MOST_SEGMENTS && is_stable(line, preferred) {
        preferred
    } else {
        dominant(line.segments).min(preferred)
    }
}

/// The valve that resists most when closed, else the element that resists most.
fn stiffest(segments: &[Segment]) -> usize {
    let rank = |segment: &Segment| match segment.element.get::<Valve>() {
        Some(valve) => (true, f64::from(valve.resistance_pa_s2_kg2(0.0))),
        None => (false, range(&segment.element).1),
    };
    let mut best = 0;
    for (place, segment) in segments.iter().enumerate() {
        if rank(segment) > rank(&segments[best]) {
            best = place;
        }
    }
    best
}

/// The last element with which the folded resistance, everything open, is at least that of all rows,
/// everything closed.
fn dominant(segments: &[Segment]) -> usize {
    let mut folded: f64 = segments.iter().map(|segment| range(&segment.element).0).sum();
    let mut rows = 0.0;
    let mut last = 0;
    for (place, segment) in segments.iter().enumerate() {
        if folded >= rows {
            last = place;
        } else {
            break;
        }
        let (least, most) = range(&segment.element);
        folded -= least;
        rows += most;
    }
    last
}

/// Smallest and largest loss at 1 kg/s over the range of the inputs.
fn range(element: &AnyComponent) -> (f64, f64) {
    let Some(spec) = element.input_spec(0) else {
        let loss = loss(element, 1.0, 1.0);
        return (loss.quadratic + loss.linear, loss.quadratic + loss.linear);
    };
    let ends = [spec.min, spec.max].map(|input| loss(element, input, 1.0));
    let [one, other] = ends.map(|loss| loss.quadratic + loss.linear);
    (one.min(other), one.max(other))
}

fn loss(element: &AnyComponent, input: f32, flow_kg_s: f64) -> Loss {
    let inputs = [input];
    let at = Operating::plain(&inputs, flow_kg_s as f32);
    let law = element.law(&at);
    Loss { quadratic: law.resistance.into(), linear: law.linear.into(), head: law.head.into() }
}

/// Whether the step is stable at the steady flow of every opening, with the flow at `place`.
fn is_stable(line: Driven<'_>, place: usize) -> bool {
    let segments = line.segments;
    let rows = &segments[..place];
    let valve = |segment: &Segment| segment.element.is::<Valve>();
    // Other valves stand open or closed together, machines run at rated or at full speed.
    let others: &[f32] = if rows.iter().any(valve) { &[1.0, 0.0] } else { &[1.0] };
    let machine = |segment: &Segment| segment.element.is::<Fan>() || segment.element.is::<Pump>();
    let speeds: &[f32] = if segments.iter().any(machine) { &[1.0, 2.0] } else { &[1.0] };
    let openings: &[f32] = if valve(&segments[place]) { &OPENINGS } else { &[1.0] };
    openings.iter().all(|&opening| {
        others.iter().all(|&other| {
            speeds.iter().all(|&speed| {
                let input = |index: usize, segment: &Segment| match segment.element.is::<Valve>() {
                    true if index == place => opening,
                    true => other,
                    false => speed,
                };
                is_stable_at(line, place, &input)
            })
        })
    })
}

fn is_stable_at(line: Driven<'_>, place: usize, input: &impl Fn(usize, &Segment) -> f32) -> bool {
    // Steady flow of R·w² + L·w = drive; laws that change with flow settle within a few rounds.
    let mut flow = 1e-2;
    let mut losses = Vec::new();
    for _ in 0..4 {
        losses.clear();
        let with_input = line.segments.iter().enumerate();
        losses.extend(with_input.map(|(index, segment)| loss(&segment.element, input(index, segment), flow)));
        let sum = losses.iter().fold(Loss::default(), |sum, loss| Loss {
            quadratic: sum.quadratic + loss.quadratic,
            linear: sum.linear + loss.linear,
            head: sum.head + loss.head,
        });
        let drive = (line.drop_pa + sum.head).abs();
        let root = libm::sqrt(sum.linear * sum.linear + 4.0 * sum.quadratic * drive);
        flow = if sum.linear + root > 0.0 { 2.0 * drive / (sum.linear + root) } else { 0.0 };
    }
    // A line that starts with more flow than it keeps takes a while to lose it.
    let flow = flow.max(line.start_flow_kg_s.abs());
    let slopes: Vec<f64> = losses.iter().map(|loss| 2.0 * loss.quadratic * flow + loss.linear).collect();
    let (rows, folded) = slopes.split_at(place);
    let own: f64 = folded.iter().sum();
    // Where the flow row dominates there is nothing to compute.
    own >= rows.iter().sum() || STEPS.iter().all(|&step| turns_once(rows, own, step))
}

/// Whether D turns once around 0 while z goes around the unit circle.
fn turns_once(rows: &[f64], own: f64, step: f64) -> bool {
    let phi = 1.0 / f64::max(step * own, 1.0);
    let value = |angle: f64| {
        // z − 1 = −2·sin²(θ/2) + i·sin θ, exact for small angles.
        let half = libm::sin(0.5 * angle);
        let (x, y) = (-2.0 * half * half, libm::sin(angle));
        let size = (x + step) * (x + step) + y * y;
        let (g_x, g_y) = (step * (x + step) / size, -step * y / size);
        // Σ b_i·g^(v−i) by Horner's rule from the first row on.
        let (mut sum_x, mut sum_y) = (0.0, 0.0);
        for slope in rows {
            let inner = sum_x + slope;
            (sum_x, sum_y) = (inner * g_x - sum_y * g_y, inner * g_y + sum_y * g_x);
        }
        (x + step * phi * (own + sum_x), y + step * phi * sum_y)
    };
    let start = 1e-3 * step;
    let factor = libm::pow(core::f64::consts::PI / start, 1.0 / f64::from(POINTS));
    let mut turned = 0.0;
    let (mut angle, mut last) = (0.0, value(0.0));
    for point in 0..=POINTS {
        let next =
            if point == POINTS { core::f64::consts::PI } else { start * libm::pow(factor, f64::from(point)) };
        let here = value(next);
        turned += turn(&value, (angle, last), (next, here), 12);
        (angle, last) = (next, here);
    }
    // Half the circle is half a turn; the other half mirrors it.
    (turned - core::f64::consts::PI).abs() < 1.0
}

/// Angle by which D turns between two points, halved until it is small.
fn turn(
    value: &impl Fn(f64) -> (f64, f64),
    (from, a): (f64, (f64, f64)),
    (to, b): (f64, (f64, f64)),
    halvings: u32,
) -> f64 {
    let angle = libm::atan2(a.0 * b.1 - a.1 * b.0, a.0 * b.0 + a.1 * b.1);
    if angle.abs() < 0.5 || halvings == 0 {
        return angle;
    }
    let middle = 0.5 * (from + to);
    let m = value(middle);
    turn(value, (from, a), (middle, m), halvings - 1) + turn(value, (middle, m), (to, b), halvings - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::components::Pipe;
    use eclss_core::example;

    fn segment(element: AnyComponent) -> Segment {
        Segment { element, inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 0 }
    }

    fn pipe(resistance_pa_s2_kg2: f32) -> Segment {
        segment(Pipe::new(resistance_pa_s2_kg2).into_any())
    }

    fn valve(open_resistance_pa_s2_kg2: f32) -> Segment {
        let valve = Valve { open_resistance_pa_s2_kg2, exponent: 3.0, leakage_opening: 1e-3 };
        segment(valve.into_any())
    }

    fn at(segments: &[Segment], drop_pa: f64, start_flow_kg_s: f64) -> usize {
        choose(Driven { segments, drop_pa, start_flow_kg_s })
    }

    /// Whether the linear step itself dies out, by doing it: the independent answer.
    fn dies_out(rows: &[f64], own: f64, step: f64, ticks: usize) -> bool {
        let phi = 1.0 / f64::max(step * own, 1.0);
        let mut q = vec![0.0; rows.len()];
        let mut w = 1.0;
        for _ in 0..ticks {
            let mut before = 0.0;
            for (q, slope) in q.iter_mut().zip(rows) {
                let old = *q;
                *q += step * (before - old - slope * w);
                before = old;
            }
            w += step * phi * (before - own * w);
            if !f64::is_finite(w) || w.abs() > 1e100 {
                return false;
            }
        }
        w.abs() < 1e-3 && q.iter().all(|q| q.abs() < 1.0)
    }

    #[test]
    fn turning_once_is_what_the_step_itself_does() {
        let mut answers = [0, 0];
        for (index, rows) in [
            vec![1e3],
            vec![20.0],
            vec![139.0, 2246.0, 923.0, 2769.0, 792.0],
            vec![139.0, 2246.0, 923.0, 2769.0, 7.0],
            vec![2.3e5, 1.0],
            vec![5.0; 30],
            vec![500.0; 30],
        ]
        .iter()
        .enumerate()
        {
            for own in [0.5, 15.0, 400.0, 3e4] {
                for step in STEPS {
                    let answer = turns_once(rows, own, step);
                    let ticks = (3e2 / step) as usize;
                    assert_eq!(answer, dies_out(rows, own, step, ticks), "case {index}, {own}, {step}");
                    answers[usize::from(answer)] += 1;
                }
            }
        }
        assert!(answers.iter().all(|&count| count >= 20), "{answers:?}");
    }

    #[test]
    fn the_paper_has_its_flow_on_the_valve() {
        assert_eq!(at(example::paper_loop().segments, 0.0, 1e-3), 5);
    }

    #[test]
    fn a_stiff_pipe_before_an_open_valve_takes_the_flow() {
        assert_eq!(at(&[pipe(800.0), pipe(4.6e7), valve(86.0)], 300.0, 0.0), 1);
        // Of two valves the later one is stiffer when both are closed, but the earlier one may be closed alone.
        assert_eq!(at(&[pipe(800.0), valve(86.0), pipe(100.0), valve(200.0)], 300.0, 0.0), 0);
        assert_eq!(at(&[pipe(800.0), valve(86.0), pipe(100.0), valve(50.0)], 300.0, 0.0), 1);
    }

    #[test]
    fn the_flow_at_the_start_counts_too() {
        let line = [pipe(4.6e7), valve(86.0)];
        assert_eq!(at(&line, 0.0, 0.0), 1);
        assert_eq!(at(&line, 0.0, 1e-3), 0);
    }

    #[test]
    fn without_a_valve_the_element_that_resists_most_has_it() {
        assert_eq!(at(&[pipe(800.0), pipe(3_000.0), pipe(20.0)], 300.0, 0.0), 1);
    }
}
