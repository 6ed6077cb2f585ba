//! The one table of signals: every figure that a network publishes, who owns it, how it is named, shown and read.
//!
//! A [`Signal`] names one figure of one owner: a pressure of a node, a flow of a line, the tank of an exchanger. Sensors,
//! process images, records, JSON, CSV, page and replay hold signals, and read them with [`Simulator::signal`]. A figure is
//! **one line** of the table below; everything else follows from it.
//!
//! An owner may publish a list of its own, as air does with the partial pressures of its parts: [`Signal::item`] counts
//! within it.

mod display;
mod list;

pub use display::{Display, Shown};

use crate::climate::VolumeView;
use crate::component::Element;
use crate::fluid::medium;
use crate::{Fingerprint, InputSpec, Simulator};

/// Kinds of owner, each with the index that [`Signal::owner`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// A node.
    Node,
    /// A line.
    Line,
    /// A line through which a gas of known density flows.
    GasLine,
    /// An element in a line, counted over all lines.
    Segment,
    /// Contents of a node, where there is a climate.
    Volume,
    /// The same where that is air.
    Air,
    /// A component with figures of its own, counted over all placed ones.
    Component,
    /// A control loop.
    Control,
    /// An input slot.
    Input,
    /// The ledgers of a climate; their only index is 0.
    Books,
    /// The run; its only index is 0.
    Run,
}

/// Whether a figure is written down when nobody chose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Listing {
    /// It is.
    Standard,
    /// Only where it is named.
    OnRequest,
}

/// Constant data of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutputSpec {
    /// Name behind the owner's id, as in `cabin.dew_point`.
    pub name: &'static str,
    /// Name for people; a pressure says whether it is gauge or absolute.
    pub label: &'static str,
    /// Unit and form.
    pub display: Display,
}

/// One figure of one owner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Signal {
    /// The figure.
    pub output: Output,
    /// Index of its owner.
    pub owner: u32,
    /// Place in a list of the owner; 0 for a single figure.
    pub item: u16,
}

macro_rules! outputs {
    ($(
        fn $read:ident[$($generic:tt)*]($($at:ident: $kind:ty),*) {$(
            $output:ident $owner:ident $listing:ident $name:literal $label:literal $display:expr => $value:expr;
        )*}
    )*) => {
        /// Figures that owners publish.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum Output {$($(
            #[doc = $label]
            $output,
        )*)*}

        impl Output {
            /// All figures, in the order of the table.
            pub const ALL: &'static [Self] = &[$($(Self::$output,)*)*];

            /// Kind of its owner.
            pub const fn owner(self) -> Owner {
                match self {$($(Self::$output => Owner::$owner,)*)*}
            }

            /// Whether it is written down when nobody chose.
            pub const fn listing(self) -> Listing {
                match self {$($(Self::$output => Listing::$listing,)*)*}
            }

            /// Name, label, unit and form, as far as they are the same for all owners.
            const fn spec(self) -> OutputSpec {
                let (name, label, display) = match self {$($(Self::$output => ($name, $label, $display),)*)*};
                OutputSpec { name, label, display }
            }

            /// Identifies the figure in hashes, wherever in the table it stands.
            const fn key(self) -> &'static str {
                match self {$($(Self::$output => stringify!($output),)*)*}
            }
        }

        $(
            /// Reads a figure of this part of the table.
            #[inline]
            pub(crate) fn $read<$($generic)*>(output: Output, $($at: $kind),*) -> f32 {
                match output {
                    $(Output::$output => $value,)*
                    _ => f32::NAN,
                }
            }
        )*
    };
}

// Figure, owner, listing, name, label, display => value. A figure is its line; it may stand anywhere in its part.
outputs! {
    fn plant[E: Element](simulator: &Simulator<'_, E>, owner: usize, item: usize) {
        Pressure Node Standard "pressure" "gauge pressure" Display::GaugePressure => simulator.node_gauge_pa(owner);
        NodePhi Node OnRequest "phi" "storage factor φ" Display::Number => simulator.node_phi(owner);
        MassFlow Line Standard "mass_flow" "mass flow" Display::MassFlow => simulator.line_flow_kg_s(owner);
        VolumeFlow GasLine Standard "volume_flow" "volume flow at the node it comes from" Display::VolumeFlow => simulator.line_volume_flow_m3_s(owner);
        LinePhi Line OnRequest "phi" "relaxation factor φ" Display::Number => simulator.line_phi(owner);
        Input Input Standard "" "input" Display::Number => at(simulator.inputs(), owner);
        Phi Run Standard "phi" "smallest φ of the last step" Display::Number => simulator.margin().phi;
        MassGap Books OnRequest "" "mass that arithmetic lost" Display::Mass => gap(simulator, item);
        EnergyGap Books OnRequest "energy_gap" "energy that arithmetic lost" Display::Other("J") => gap(simulator, MASSES.len());
        SpectralBound Run Standard "spectral_bound" "bound of the spectral radius" Display::Number => simulator.margin().spectral_bound;
    }
    fn segment[](flow_kg_s: f32, outlet_gauge_pa: f32) {
        SegmentFlow Segment Standard "mass_flow" "mass flow at the inlet" Display::MassFlow => flow_kg_s;
        OutletPressure Segment Standard "outlet_pressure" "gauge pressure at the outlet" Display::GaugePressure => outlet_gauge_pa;
    }
    fn volume[](volume: &VolumeView<'_>, item: usize) {
        Temperature Volume Standard "temperature" "temperature" Display::Temperature => volume.temperature_k();
        DewPoint Air Standard "dew_point" "dew point" Display::Temperature => volume.dew_point_k();
        RelativeHumidity Air Standard "relative_humidity" "relative humidity" Display::Ratio => volume.relative_humidity();
        TotalPressure Air Standard "total_pressure" "absolute pressure" Display::AbsolutePressure => volume.pressure_pa();
        PartialPressure Air Standard "" "partial pressure" Display::PartialPressure => volume.partial_pa(item);
        Turnover Air Standard "turnover" "time in which inflow renews the volume" Display::Time => volume.turnover_s();
        FreeWater Air Standard "liquid" "free liquid water" Display::Mass => volume.liquid_kg();
        Mixed Air Standard "mixed" "well mixed: 1, or 0" Display::Count => f32::from(u8::from(volume.mixed()));
    }
    fn component[](value: f32) {
        Figure Component Standard "" "figure" Display::Number => value;
    }
    fn control[](reading: f32, position: f32) {
        Reading Control Standard "reading" "reading of the sensor" Display::Number => reading;
        Position Control Standard "position" "position of the actuator" Display::Ratio => position;
    }
}

/// Gaps of the ledgers that count masses, in their order; the one of energy is the last.
const MASSES: [&str; 6] =
    ["nitrogen_gap", "oxygen_gap", "carbon_dioxide_gap", "trace_gap", "water_gap", "coolant_gap"];

fn gap<E: Element>(simulator: &Simulator<'_, E>, ledger: usize) -> f32 {
    simulator.ledgers().get(ledger).map_or(f32::NAN, |ledger| ledger.gap() as f32)
}

fn at(list: &[f32], index: usize) -> f32 {
    list.get(index).copied().unwrap_or(f32::NAN)
}

impl Output {
    /// The figure of the owner with this index.
    pub const fn of(self, owner: usize) -> Signal {
        Signal { output: self, owner: owner as u32, item: 0 }
    }

    /// The figure at a place in the owner's list.
    pub const fn item(self, owner: usize, item: usize) -> Signal {
        Signal { output: self, owner: owner as u32, item: item as u16 }
    }

    /// Names of the places in an owner's list; `None` for a single figure.
    const fn list(self) -> Option<&'static [&'static str]> {
        match self {
            // Free liquid has no partial pressure.
            Self::PartialPressure => Some(medium::NAMES.split_at(medium::LIQUID).0),
            Self::MassGap => Some(&MASSES),
            _ => None,
        }
    }

    /// How many figures of this kind an owner has.
    pub fn items(self) -> usize {
        self.list().map_or(1, <[_]>::len)
    }
}

impl Signal {
    /// Name, label, unit and form. Those of an input are its [`InputSpec`]'s, the form of a control's reading is that of
    /// the signal that it measures; see [`OutputSpec::of_input`] and [`Signal::spec_in`].
    pub fn spec(self) -> OutputSpec {
        let spec = self.output.spec();
        let name = self.output.list().and_then(|names| names.get(usize::from(self.item)));
        OutputSpec { name: name.copied().unwrap_or(spec.name), ..spec }
    }

    /// Whether a climate by itself can read the signal, so that its sensors can look at it.
    pub const fn is_measurable(self) -> bool {
        matches!(self.output.owner(), Owner::Volume | Owner::Air | Owner::Component)
    }

    /// Adds the signal to a hash; its place in the table does not count.
    pub(crate) fn hash_into(self, hash: &mut Fingerprint) {
        self.output.key().bytes().for_each(|byte| hash.word(u32::from(byte)));
        hash.word(self.owner);
        hash.word(u32::from(self.item));
    }
}

impl OutputSpec {
    /// Unit of the values; `1` for a ratio.
    pub const fn unit(&self) -> &'static str {
        self.display.unit()
    }

    /// Figure that an input publishes.
    pub fn of_input(input: &InputSpec) -> Self {
        Self { name: input.name, label: "input", display: Display::of_input(input) }
    }
}
