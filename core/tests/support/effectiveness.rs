//! The effectiveness table of the station's condensing heat exchanger, and a coil brought to rest.
//!
//! Table: SAE 2005-01-2801, through V-HAB; coolant 600 lb/h at 40 °F. The source does not say which effectiveness it
//! is. [assumed] Air flows are volume flows at the inlet, at 101 325 Pa.

use eclss_core::components::coil::{CELLS, Coil, Condenser, Drained};
use eclss_core::fluid::medium::{Medium, VAPOUR};
use eclss_core::fluid::stream::Stream;
use eclss_core::moist;

pub(crate) const PRESSURE_PA: f32 = 101_325.0;
const REFERENCE_K: f32 = 295.15;
const WATER_J_KG_K: f32 = moist::LIQUID_HEAT_J_KG_K;

/// Dew points [°F] of the rows and their effectiveness at 50, 100 … 450 cfm, for air at 67 °F.
pub(crate) const AT_67_F: [(f32, [f32; 9]); 4] = [
    (42.0, [1.000, 0.985, 0.970, 0.955, 0.925, 0.890, 0.845, 0.805, 0.760]),
    (48.0, [1.000, 0.980, 0.960, 0.925, 0.880, 0.840, 0.805, 0.770, 0.740]),
    (54.0, [1.000, 0.975, 0.945, 0.910, 0.840, 0.780, 0.730, 0.690, 0.655]),
    (60.0, [1.000, 0.960, 0.920, 0.865, 0.790, 0.720, 0.650, 0.600, 0.555]),
];
/// The same for air at 75 °F.
pub(crate) const AT_75_F: [(f32, [f32; 9]); 4] = [
    (42.0, [1.000, 0.990, 0.975, 0.960, 0.930, 0.895, 0.850, 0.810, 0.770]),
    (48.0, [1.000, 0.985, 0.965, 0.935, 0.895, 0.860, 0.830, 0.800, 0.765]),
    (54.0, [1.000, 0.980, 0.960, 0.920, 0.865, 0.810, 0.770, 0.730, 0.700]),
    (60.0, [1.000, 0.970, 0.940, 0.900, 0.825, 0.760, 0.705, 0.660, 0.625]),
];

/// What enters a coil.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inlet {
    pub(crate) air_k: f32,
    pub(crate) dew_point_k: f32,
    /// Volume flow of moist air at the inlet [m³/s].
    pub(crate) air_m3_s: f32,
    pub(crate) coolant_k: f32,
    pub(crate) coolant_kg_s: f32,
}

impl Inlet {
    /// A point of the table: temperatures in °F, flow in cfm.
    pub(crate) fn of_table(air_f: f32, dew_point_f: f32, cfm: f32) -> Self {
        Self {
            air_k: kelvin(air_f),
            dew_point_k: kelvin(dew_point_f),
            air_m3_s: cfm * 4.719_474e-4,
            coolant_k: kelvin(40.0),
            coolant_kg_s: 0.075_598_7,
        }
    }
}

pub(crate) fn kelvin(fahrenheit: f32) -> f32 {
    (fahrenheit - 32.0) / 1.8 + 273.15
}

/// A coil at rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtRest {
    pub(crate) air_out_k: f32,
    pub(crate) coolant_out_k: f32,
    pub(crate) humidity_in: f32,
    pub(crate) humidity_out: f32,
    /// Heat that the air loses [W], in the last step.
    pub(crate) air_w: f32,
    /// Heat that the coolant takes [W], in the last step.
    pub(crate) coolant_w: f32,
    /// What the whole run put into the coil and its own state does not hold, over what was put in [1]: energy, water.
    pub(crate) unbalance: [f64; 2],
    pub(crate) condensed_kg_s: f32,
    pub(crate) drained_kg_s: f32,
    /// `(T_in − T_out)/(T_in − T_c)`
    pub(crate) by_temperature: f32,
    /// `(h_in − h_out)/(h_in − h(T_c, saturated or as humid as the inlet))`
    pub(crate) by_enthalpy: f32,
}

/// Runs a coil for `steps` steps of `step_s` from dry walls at the coolant's temperature.
pub(crate) fn at_rest(condenser: &Condenser, inlet: Inlet, steps: u32, step_s: f32) -> AtRest {
    let (air, water) = (Medium::air(REFERENCE_K), Medium::coolant(WATER_J_KG_K));
    let vapour_pa = moist::saturation_pressure_pa(inlet.dew_point_k);
    let dry_kg_s = inlet.air_m3_s * (PRESSURE_PA - vapour_pa) / (287.05 * inlet.air_k);
    let dry_kg = dry_kg_s * step_s;
    // 75.5 % nitrogen and 24.5 % oxygen; a little lighter than air with its argon.
    let mut entering =
        Stream { mass_kg: [0.755 * dry_kg, 0.245 * dry_kg, 0.0, 0.0, 0.0, 0.0], energy_j: 0.0 };
    let ratio = entering.vapour_of_equal_moles_kg() / dry_kg;
    let humidity_in = ratio * moist::moles_per_dry_mole(vapour_pa, PRESSURE_PA);
    entering.mass_kg[VAPOUR] = humidity_in * dry_kg;
    entering.energy_j = entering.capacity_j_k(&air) * (inlet.air_k - REFERENCE_K);
    let coolant_mass = inlet.coolant_kg_s * step_s;
    let mut coolant_in = Stream { mass_kg: [coolant_mass, 0.0, 0.0, 0.0, 0.0, 0.0], energy_j: 0.0 };
    coolant_in.energy_j = coolant_mass * WATER_J_KG_K * (inlet.coolant_k - REFERENCE_K);
    let (mut walls, mut figures) = ([[0.0; CELLS]; 4], [[0.0; CELLS]; 3]);
    let start_theta_k = inlet.coolant_k - REFERENCE_K;
    let mut coil = Coil {
        condenser,
        air: &air,
        clean: 1.0,
        reference_k: REFERENCE_K,
        start_theta_k,
        walls: &mut walls,
        figures: &mut figures,
    };
    let (mut out, mut coolant_out, mut drained) = (entering, coolant_in, Drained::default());
    // What came in net, and all that was exchanged.
    let (mut net, mut exchanged) = ([0.0f64; 2], [0.0f64; 2]);
    for _ in 0..steps {
        (out, coolant_out) = (entering, coolant_in);
        coil.begin();
        coil.pass_air(&mut out, step_s, PRESSURE_PA, false);
        coil.pass_coolant(&mut coolant_out, step_s, &water);
        drained = coil.settle();
        let of = |from: f32, to: f32| f64::from(from) - f64::from(to);
        let air_j = of(entering.energy_j, out.energy_j);
        let water_kg = of(entering.mass_kg[VAPOUR], out.mass_kg[VAPOUR]);
        net[0] += air_j - of(coolant_out.energy_j, coolant_in.energy_j) - f64::from(drained.energy_j);
        net[1] += water_kg - f64::from(drained.water_kg);
        exchanged[0] += air_j.abs();
        exchanged[1] += water_kg.abs();
    }
    for place in 0..CELLS {
        let [energy, energy_carry, film, film_carry] = walls.map(|cells| f64::from(cells[place]));
        net[0] -= energy - energy_carry;
        net[1] -= film - film_carry;
    }
    let unbalance = [net[0] / exchanged[0], net[1] / exchanged[1].max(1e-9)];
    let air_out_k = REFERENCE_K + out.theta_k(&air);
    let humidity_out = out.mass_kg[VAPOUR] / dry_kg;
    let saturated =
        ratio * moist::moles_per_dry_mole(moist::saturation_pressure_pa(inlet.coolant_k), PRESSURE_PA);
    let h = moist::enthalpy_j_kg;
    let (h_in, h_out) = (h(inlet.air_k, humidity_in), h(air_out_k, humidity_out));
    let h_best = h(inlet.coolant_k, saturated.min(humidity_in));
    AtRest {
        air_out_k,
        coolant_out_k: REFERENCE_K + coolant_out.theta_k(&water),
        humidity_in,
        humidity_out,
        coolant_w: (coolant_out.energy_j - coolant_in.energy_j) / step_s,
        air_w: (entering.energy_j - out.energy_j) / step_s,
        unbalance,
        condensed_kg_s: (entering.mass_kg[VAPOUR] - out.mass_kg[VAPOUR]) / step_s,
        drained_kg_s: drained.water_kg / step_s,
        by_temperature: (inlet.air_k - air_out_k) / (inlet.air_k - inlet.coolant_k),
        by_enthalpy: (h_in - h_out) / (h_in - h_best),
    }
}

/// Relative errors of all points of a table by one reading.
pub(crate) fn errors(
    condenser: &Condenser,
    air_f: f32,
    rows: &[(f32, [f32; 9]); 4],
    read: fn(&AtRest) -> f32,
) -> Vec<f32> {
    let mut list = Vec::new();
    for (dew_point_f, row) in rows {
        for (column, printed) in row.iter().enumerate() {
            let inlet = Inlet::of_table(air_f, *dew_point_f, 50.0 * (column as f32 + 1.0));
            list.push(read(&at_rest(condenser, inlet, 900, 0.2)) / printed - 1.0);
        }
    }
    list
}

/// Largest and mean size of a list of errors.
pub(crate) fn largest_and_mean(errors: &[f32]) -> (f32, f32) {
    let largest = errors.iter().fold(0.0f32, |largest, error| largest.max(error.abs()));
    (largest, errors.iter().map(|error| error.abs()).sum::<f32>() / errors.len() as f32)
}
