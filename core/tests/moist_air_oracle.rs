//! Moist air against psychrolib, whose table `core/tests/data/moist_air.csv` is made by the script beside it.

use eclss_core::moist;

const TABLE: &str = include_str!("data/moist_air.csv");

#[test]
fn agrees_with_psychrolib_over_cabin_conditions() {
    let mut worst = [0.0f32; 4];
    let mut rows = 0;
    for row in TABLE.lines().skip(1) {
        let values: Vec<f32> = row.split(',').map(|value| value.parse().unwrap()).collect();
        let [t, rh, pressure, saturation, dew_point, ratio, enthalpy] = values[..] else { panic!("{row}") };
        if dew_point < 0.0 {
            // There ASHRAE means frost, this project supercooled water.
            continue;
        }
        let temperature = t + moist::ZERO_CELSIUS_K;
        let own = moist::saturation_pressure_pa(temperature);
        let w = moist::humidity_ratio(rh * own, pressure);
        let errors = [
            (own / saturation - 1.0).abs(),
            (moist::dew_point_k(rh * own) - moist::ZERO_CELSIUS_K - dew_point).abs(),
            (w / ratio - 1.0).abs(),
            (moist::enthalpy_j_kg(temperature, w) / enthalpy - 1.0).abs(),
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
        rows += 1;
    }
    println!("{rows} rows: saturation, dew point [K], humidity ratio, enthalpy: {worst:?}");
    assert_eq!(rows, 72);
    // Two formulas for the same water: Buck here, ASHRAE there.
    assert!(worst[0] < 1e-3 && worst[1] < 0.02 && worst[2] < 2e-3 && worst[3] < 1.5e-3, "{worst:?}");
}
