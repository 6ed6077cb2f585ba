"""Writes moist_air.csv: moist air by psychrolib (ASHRAE Fundamentals 2017), an oracle independent of this project.

    pip install psychrolib==2.5.0
    python core/tests/data/moist_air.py > core/tests/data/moist_air.csv
"""

import psychrolib

psychrolib.SetUnitSystem(psychrolib.SI)
print("temperature_c,relative_humidity,pressure_pa,saturation_pa,dew_point_c,humidity_ratio,enthalpy_j_kg")
for pressure in (70_000.0, 101_325.0):
    for t in range(5, 51, 5):
        for rh in (0.3, 0.5, 0.75, 1.0):
            w = psychrolib.GetHumRatioFromRelHum(t, rh, pressure)
            print(
                f"{t},{rh},{pressure},{psychrolib.GetSatVapPres(t):.6g},{psychrolib.GetTDewPointFromRelHum(t, rh):.5f},"
                f"{w:.8g},{psychrolib.GetMoistAirEnthalpy(t, w):.7g}"
            )
