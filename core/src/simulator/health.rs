//! Whether a run may be trusted, and where it left its range if not.

/// Where a value left its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Place {
    /// Pressure of this node.
    Node(u32),
    /// Flow of this line.
    Line(u32),
}

/// A value became NaN, infinite or larger than anything in a space station: the run is no longer trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// The tick that produced it, counted from 1.
    pub tick: u64,
    /// The first place that left its range.
    pub place: Place,
}

impl Fault {
    /// Largest mass flow of any line [kg/s].
    pub const FLOW_LIMIT_KG_S: f32 = 1e3;
    /// Largest deviation of any pressure from the reference [Pa]. An absolute pressure below zero is out of range
    /// as well.
    pub const GAUGE_LIMIT_PA: f32 = 1e7;

    /// Whether a gauge pressure over `reference_pa` is out of range; vacuum itself, with its rounding, is not.
    pub(crate) fn outside(gauge_pa: f32, reference_pa: f32) -> bool {
        crate::math::beyond(gauge_pa, Self::GAUGE_LIMIT_PA) || gauge_pa < -reference_pa
    }
}

/// Whether a run may be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Health {
    /// Every value is finite and in range.
    Trusted,
    /// A value left its range; the state stands still since then.
    Faulted(Fault),
}
