//! Liquid to liquid: the coil with coolant on both sides against the textbook's counterflow exchanger.

use eclss_core::components::coil::{CELLS, Coil, Condenser};
use eclss_core::fluid::medium::Medium;
use eclss_core::fluid::stream::Stream;

const REFERENCE_K: f32 = 295.15;
const WATER_J_KG_K: f32 = 4_186.0;
const PLATES: Condenser = Condenser {
    air_w_k: 1_500.0,
    air_reference_kg_s: 0.15,
    air_exponent: 0.46,
    coolant_w_k: 1_200.0,
    coolant_reference_kg_s: 0.1,
    ..Condenser::CCAA
};

/// Outlet temperatures over the reference [K] of a hot and a cold side with these flows [kg/s] after a long while, and
/// the heat [W] that each of them lost or took.
fn at_rest(
    hot_kg_s: f32,
    cold_kg_s: f32,
    theta_k: [f32; 2],
    clean: f32,
    reversed: bool,
) -> ([f32; 2], [f32; 2]) {
    let (step_s, water, air) = (0.2f32, Medium::coolant(WATER_J_KG_K), Medium::air(REFERENCE_K));
    let (mut walls, mut figures) = ([[0.0; CELLS]; 4], [[0.0; CELLS]; 3]);
    let mut coil = Coil {
        condenser: &PLATES,
        air: &air,
        clean,
        reference_k: REFERENCE_K,
        start_theta_k: 0.0,
        walls: &mut walls,
        figures: &mut figures,
    };
    let [hot_k, cold_k] = theta_k;
    let entering = [
        Stream::of_coolant(hot_kg_s * step_s, hot_k, &water),
        Stream::of_coolant(cold_kg_s * step_s, cold_k, &water),
    ];
    let mut leaving = entering;
    for _ in 0..20_000 {
        leaving = entering;
        coil.begin();
        coil.pass_liquid(&mut leaving[0], step_s, &water, reversed);
        coil.pass_coolant(&mut leaving[1], step_s, &water);
        coil.settle();
    }
    let heat = |side: usize| (entering[side].energy_j - leaving[side].energy_j) / step_s;
    (leaving.map(|stream| stream.theta_k(&water)), [heat(0), -heat(1)])
}

/// ε = (1 − e^(−N(1−c)))/(1 − c·e^(−N(1−c))), Kays and London; N/(1 + N) for equal capacities.
fn counterflow(ntu: f64, ratio: f64) -> f64 {
    if (ratio - 1.0).abs() < 1e-9 {
        return ntu / (1.0 + ntu);
    }
    let decay = (-ntu * (1.0 - ratio)).exp();
    (1.0 - decay) / (1.0 - ratio * decay)
}

#[test]
fn two_liquids_exchange_by_effectiveness_and_transfer_units() {
    let mut worst = 0.0f64;
    for hot in [0.04f32, 0.1, 0.155] {
        for cold in [0.05f32, 0.1, 0.2] {
            for (clean, theta_k) in [(1.0f32, [12.0f32, -17.0]), (0.4, [-3.0, 20.0])] {
                let (_, [lost_w, taken_w]) = at_rest(hot, cold, theta_k, clean, false);
                assert!(
                    (lost_w / taken_w - 1.0).abs() < 1e-4,
                    "what one loses the other takes: {lost_w}, {taken_w}"
                );
                let [hot, cold, clean] = [hot, cold, clean].map(f64::from);
                let side = |conductance: f64, flow: f64, reference: f64| {
                    clean * conductance * (flow / reference).powf(0.46)
                };
                let conductance = 1.0 / (1.0 / side(1_500.0, hot, 0.15) + 1.0 / side(1_200.0, cold, 0.1));
                let (least, most) = (4_186.0 * hot.min(cold), 4_186.0 * hot.max(cold));
                let exact = counterflow(conductance / least, least / most)
                    * least
                    * f64::from(theta_k[0] - theta_k[1]);
                let error = f64::from(lost_w) / exact - 1.0;
                worst = worst.max(error.abs());
                assert!(error.abs() < 0.01, "{hot} and {cold} kg/s: {lost_w} W for {exact} W");
            }
        }
    }
    println!("liquid to liquid: largest error {worst:.1e} of ε-NTU");
}

#[test]
fn no_outlet_passes_the_other_inlet_and_with_the_stream_the_exchanger_is_worse() {
    let ([hot, cold], [counter_w, _]) = at_rest(0.1, 0.1, [12.0, -17.0], 1.0, false);
    assert!(hot > -17.0 && cold < 12.0 && cold > hot - 29.0, "{hot} {cold}");
    // Reversed, both sides run the same way: N = U/C, ε = (1 − e^(−2N))/2 at equal capacities.
    let (_, [parallel_w, _]) = at_rest(0.1, 0.1, [12.0, -17.0], 1.0, true);
    let conductance = 1.0 / (1.0 / (1_500.0 * (0.1f64 / 0.15).powf(0.46)) + 1.0 / 1_200.0);
    let exact = 0.5 * (1.0 - (-2.0 * conductance / 418.6).exp()) * 418.6 * 29.0;
    assert!((f64::from(parallel_w) / exact - 1.0).abs() < 0.01, "{parallel_w} W for {exact} W");
    assert!(parallel_w < counter_w);
}
