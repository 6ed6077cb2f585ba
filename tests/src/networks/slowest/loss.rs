//! What a part of a line loses near its steady flow: slopes, chords and secants.

use std::ops::Range;

use eclss_core::{Element, Line, Network};

/// Pressures that count as rest when a line's direction is asked for [Pa]: ten times what a settled one may be off.
const REST_PA: f64 = 1e-3;

/// Loss of a part of a line near rest and at flow, in one direction: `R·w·max(|w|, w_lin) + L·w`.
#[derive(Clone, Copy)]
struct Loss {
    quadratic: f64,
    linear: f64,
    laminar: f64,
    head: f64,
}

impl Loss {
    fn of(network: &Network<'_>, line: &Line, segments: Range<usize>, w: f64, forward: bool) -> Self {
        let mut loss = Self { quadratic: 0.0, linear: 0.0, laminar: 0.0, head: 0.0 };
        let mut whole = 0.0f64;
        for (index, segment) in network.segments_of(line).iter().enumerate() {
            let inputs = network.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            let at = eclss_core::Operating::plain(inputs, w as f32);
            let law = if forward { segment.element.law(&at) } else { segment.element.reverse_law(&at) };
            whole += f64::from(law.resistance);
            if segments.contains(&index) {
                loss.quadratic += f64::from(law.resistance);
                loss.linear += f64::from(law.linear);
                loss.head += f64::from(law.head);
            }
        }
        // A line of closed check valves alone has nothing but linear leaks.
        loss.laminar = (f64::from(line.laminar_below_pa) / whole.max(f64::MIN_POSITIVE)).sqrt().min(1e6);
        loss
    }

    /// Flow at the driving pressure `y`, head included [kg/s].
    fn flow(&self, y: f64) -> f64 {
        let laminar = y / (self.quadratic * self.laminar + self.linear);
        if laminar.abs() < self.laminar {
            return laminar;
        }
        2.0 * y / (self.linear + (self.linear * self.linear + 4.0 * self.quadratic * y.abs()).sqrt())
    }

    fn at(&self, w: f64) -> f64 {
        self.quadratic * w * w.abs().max(self.laminar) + self.linear * w
    }

    fn slope(&self, w: f64) -> f64 {
        self.quadratic * if w.abs() > self.laminar { 2.0 * w.abs() } else { self.laminar } + self.linear
    }
}

/// Losses of a part of a line around a flow in both directions, which differ where it has check valves.
pub(crate) struct Losses {
    forward: Loss,
    reverse: Loss,
    /// The flow [kg/s].
    w: f64,
}

impl Losses {
    /// Those of some segments of a line. Its laminar flow is that of the whole line.
    pub(crate) fn of(network: &Network<'_>, line: &Line, segments: Range<usize>, w: f64) -> Self {
        let direction = |forward| Loss::of(network, line, segments.clone(), w, forward);
        Self { forward: direction(true), reverse: direction(false), w }
    }

    fn toward(&self, w: f64) -> &Loss {
        if w < 0.0 { &self.reverse } else { &self.forward }
    }

    /// Difference between the pressures that drive this flow and another [Pa].
    pub(crate) fn apart_pa(&self, other: f64) -> f64 {
        (self.toward(self.w).at(self.w) - self.toward(other).at(other)).abs()
    }

    /// Pressure that the flow loses, less the head [Pa].
    pub(crate) fn drop_pa(&self) -> f64 {
        self.drive_pa() - self.toward(self.w).head
    }

    /// Pressure that drives the flow, its head included [Pa].
    fn drive_pa(&self) -> f64 {
        self.toward(self.w).at(self.w)
    }

    /// Slope of flow over pressure at the flow; the smaller of both directions where it rests [kg/(s·Pa)].
    pub(crate) fn slope(&self) -> f64 {
        if self.drive_pa().abs() > REST_PA {
            return 1.0 / self.toward(self.w).slope(self.w);
        }
        (1.0 / self.forward.slope(self.w)).min(1.0 / self.reverse.slope(self.w))
    }

    /// The larger of both directions where it rests: inertance swings longest through what is open [kg/(s·Pa)].
    pub(crate) fn widest(&self) -> f64 {
        if self.drive_pa().abs() > REST_PA {
            return self.slope();
        }
        (1.0 / self.forward.slope(self.w)).max(1.0 / self.reverse.slope(self.w))
    }

    /// Slope of the chord from the flow to that at a drive which is larger `by` [Pa].
    pub(crate) fn chord(&self, by: f64) -> f64 {
        let y = self.drive_pa() + by;
        if by.abs() > 0.0 { (self.toward(y).flow(y) - self.w) / by } else { f64::MAX }
    }

    /// w/y as the operator looks at it: the larger of both directions [kg/(s·Pa)].
    pub(crate) fn secant(&self) -> f64 {
        let y = self.drive_pa().abs().max(f64::MIN_POSITIVE);
        (self.forward.flow(y) / y).max(self.reverse.flow(y) / y)
    }
}
