//! The condensing heat exchanger against its effectiveness table, its limits and its balances.

#[path = "support/effectiveness.rs"]
mod effectiveness;

use eclss_core::components::coil::{CELLS, Coil, Condenser};
use eclss_core::fluid::medium::{Medium, VAPOUR};
use eclss_core::fluid::stream::Stream;
use effectiveness::{AT_67_F, AT_75_F, Inlet, at_rest, errors, kelvin, largest_and_mean};

const CCAA: Condenser = Condenser::CCAA;

#[test]
fn rows_that_were_not_fitted_come_out_within_five_percent() {
    let (largest, mean) = largest_and_mean(&errors(&CCAA, 75.0, &AT_75_F, |rest| rest.by_temperature));
    println!("75 °F by temperature: largest {largest}, mean {mean}");
    assert!(largest <= 0.05 && mean <= 0.02);
}

/// The fit of `cargo run --release -p eclss-core --example fit_condenser` by the other reading of the effectiveness.
const BY_ENTHALPY: Condenser =
    Condenser { air_w_k: 563.4, air_exponent: 0.9984, coolant_w_k: 33_803.0, ..CCAA };

#[test]
fn the_temperature_reading_fits_better_than_the_enthalpy_reading() {
    let (largest, temperature) = largest_and_mean(&errors(&CCAA, 67.0, &AT_67_F, |rest| rest.by_temperature));
    let (other, enthalpy) = largest_and_mean(&errors(&BY_ENTHALPY, 67.0, &AT_67_F, |rest| rest.by_enthalpy));
    println!("67 °F, fitted: {largest}, mean {temperature} by temperature; {other}, {enthalpy} by enthalpy");
    assert!(temperature < enthalpy && largest < other);
    let (other, enthalpy) = largest_and_mean(&errors(&BY_ENTHALPY, 75.0, &AT_75_F, |rest| rest.by_enthalpy));
    println!("75 °F: {other}, mean {enthalpy} by enthalpy");
    assert!(other > 0.05 && enthalpy > 0.02);
}

/// Conditions over the whole range in which a cabin's exchanger works.
fn conditions() -> impl Iterator<Item = Inlet> {
    let flows = [0.02f32, 0.1, 0.2];
    flows.into_iter().flat_map(|air_m3_s| {
        [0.074f32, 0.1, 0.145].into_iter().flat_map(move |coolant_kg_s| {
            [18.0f32, 22.0, 26.0].into_iter().flat_map(move |air_c| {
                [3.0f32, 9.0, 15.0].into_iter().map(move |dew_point_c| Inlet {
                    air_k: 273.15 + air_c,
                    dew_point_k: 273.15 + dew_point_c,
                    air_m3_s,
                    coolant_k: 277.4,
                    coolant_kg_s,
                })
            })
        })
    })
}

#[test]
fn heat_and_water_balance_over_a_whole_run() {
    for inlet in conditions() {
        let rest = at_rest(&CCAA, inlet, 6_000, 0.2);
        let [energy, water] = rest.unbalance;
        // What is left is the rounding of the streams' own sums.
        assert!(energy.abs() < 2e-6 && water.abs() < 2e-6, "{inlet:?}: {rest:?}");
    }
}

#[test]
fn air_leaves_no_colder_than_the_coolant_and_no_wetter_than_it_came() {
    for inlet in conditions() {
        let rest = at_rest(&CCAA, inlet, 1_500, 0.2);
        assert!(rest.air_out_k >= inlet.coolant_k - 1e-3, "{inlet:?}: {rest:?}");
        assert!(rest.humidity_out <= rest.humidity_in, "{inlet:?}: {rest:?}");
        assert!(rest.coolant_out_k <= inlet.air_k, "{inlet:?}: {rest:?}");
    }
}

#[test]
fn a_coil_above_the_dew_point_stays_dry() {
    for inlet in conditions() {
        let dry = Inlet { dew_point_k: inlet.coolant_k - 0.1, ..inlet };
        let rest = at_rest(&CCAA, dry, 1_500, 0.2);
        assert!(rest.condensed_kg_s.abs() < f32::MIN_POSITIVE && rest.drained_kg_s.abs() < f32::MIN_POSITIVE);
    }
}

#[test]
fn more_coolant_never_warms_the_air_or_dries_it_less() {
    for inlet in conditions().filter(|inlet| inlet.coolant_kg_s < 0.08) {
        let mut last = at_rest(&CCAA, Inlet { coolant_kg_s: 0.05, ..inlet }, 1_500, 0.2);
        for step in 1..=8 {
            let coolant_kg_s = 0.05 + 0.0125 * step as f32;
            let rest = at_rest(&CCAA, Inlet { coolant_kg_s, ..inlet }, 1_500, 0.2);
            assert!(rest.air_out_k <= last.air_out_k + 2e-4, "{inlet:?} at {coolant_kg_s}");
            assert!(rest.condensed_kg_s >= last.condensed_kg_s - 1e-9, "{inlet:?} at {coolant_kg_s}");
            last = rest;
        }
    }
}

/// The fits of `cargo run --release -p eclss-core --example fit_condenser sensitivity` with `U_c` held far off either
/// way: what the table leaves open about the coolant's side moves the heat by less than 2 %.
#[test]
fn what_the_table_leaves_open_hardly_moves_the_heat() {
    let weak = Condenser { air_w_k: 554.3, air_exponent: 0.5606, coolant_w_k: 4_000.0, ..CCAA };
    let strong = Condenser { air_w_k: 481.7, air_exponent: 0.5689, coolant_w_k: 20_000.0, ..CCAA };
    for inlet in conditions().filter(|inlet| inlet.air_m3_s > 0.05) {
        let [own, weak, strong] =
            [CCAA, weak, strong].map(|coil| at_rest(&coil, inlet, 1_500, 0.2).coolant_w);
        for other in [weak, strong] {
            assert!((other / own - 1.0).abs() < 0.02, "{inlet:?}: {own} W, {other} W");
        }
    }
}

#[test]
fn a_dry_coil_is_the_counterflow_exchanger_of_the_textbooks() {
    // ε = (1 − e^(−N(1−c)))/(1 − c·e^(−N(1−c))), Kays and London, with the conductances of both sides in series.
    let inlet = Inlet {
        air_k: 297.0,
        dew_point_k: kelvin(33.0),
        air_m3_s: 0.15,
        coolant_k: 277.6,
        coolant_kg_s: 0.075_6,
    };
    let rest = at_rest(&CCAA, inlet, 1_500, 0.2);
    let dry = 0.15 * (101_325.0 - 634.0) / (287.05 * 297.0);
    let air = rest.air_w / (297.0 - rest.air_out_k);
    let water = 0.075_6 * 4_186.0;
    let conductance =
        1.0 / (1.0 / (CCAA.air_w_k * (dry / 0.1f32).powf(CCAA.air_exponent)) + 1.0 / CCAA.coolant_w_k);
    let (least, most) = (air.min(water), air.max(water));
    let (n, c) = (conductance / least, least / most);
    let decay = (-n * (1.0 - c)).exp();
    let effectiveness = (1.0 - decay) / (1.0 - c * decay);
    println!("{} against {effectiveness}", rest.by_temperature);
    assert!((rest.by_temperature / effectiveness - 1.0).abs() < 0.01);
}

/// Air that stays as long as it likes over cold walls leaves saturated: with `p_s/(p − p_s)` moles of water per mole of dry
/// gas, whatever that gas and the pressure are. Against Buck's formula and molar masses in double precision.
#[test]
fn saturation_counts_moles_of_the_gas_that_flows() {
    let (reference_k, wall_c) = (295.15f32, 8.0f64);
    let air = Medium::air(reference_k);
    let molar = [28.013_4f64, 31.998, 44.009, 18.015, 28.965];
    let buck = 611.21 * ((18.678 - wall_c / 234.5) * (wall_c / (257.14 + wall_c))).exp();
    for (parts, pressure_pa) in [
        ([0.755f32, 0.245, 0.0, 0.0], 101_325.0f32),
        ([0.0, 1.0, 0.0, 0.0], 34_500.0),
        ([0.5, 0.2, 0.3, 0.0], 70_000.0),
        ([0.0, 0.0, 0.9, 0.1], 101_325.0),
    ] {
        let [nitrogen, oxygen, carbon_dioxide, trace] = parts.map(|part| 1e-4 * part);
        let mass_kg = [nitrogen, oxygen, carbon_dioxide, 5e-6, trace, 0.0];
        let mut stream = Stream { mass_kg, energy_j: 0.0 };
        stream.energy_j = stream.capacity_j_k(&air) * 5.0;
        let (mut walls, mut figures) = ([[0.0; CELLS]; 4], [[0.0; CELLS]; 3]);
        let mut coil = Coil {
            condenser: &CCAA,
            air: &air,
            clean: 1.0,
            reference_k,
            start_theta_k: 273.15 + wall_c as f32 - reference_k,
            walls: &mut walls,
            figures: &mut figures,
        };
        coil.begin();
        coil.pass_air(&mut stream, 0.1, pressure_pa, false);
        let moles: f64 = [(0, 0), (1, 1), (2, 2), (4, 4)]
            .map(|(part, gas)| f64::from(mass_kg[part]) / molar[gas])
            .iter()
            .sum();
        let exact = moles * molar[VAPOUR] * buck / (f64::from(pressure_pa) - buck);
        let found = f64::from(stream.vapour_kg());
        assert!((found / exact - 1.0).abs() < 1e-5, "{parts:?}: {found} kg for {exact} kg");
    }
}
