//! The air of a cabin on the page: figures against limits, charts, malfunctions, units.

use super::{assert_quiet, opened};

/// Text of the row of a quantity in the table of the air.
fn row(name: &str) -> String {
    format!(
        "[...document.querySelectorAll('#air-rows tr')].find(row => row.firstChild.textContent === '{name}').innerText"
    )
}

#[test]
fn a_failed_scrubber_raises_co2_beyond_its_limit_and_the_page_says_so() {
    let (plant, browser) = opened("thcs.toml");
    for chart in
        ["flow", "pressure", "temperature", "dew_point", "relative_humidity", "carbon_dioxide", "condensate"]
    {
        browser.wait(
            chart,
            &format!("return /: .* [\\d.−]+ /.test(document.querySelector('#{chart}-chart').getAttribute('aria-label'))"),
        );
    }
    let within = format!("return !{}.includes('too high')", row("CO2"));
    browser.wait("the day begins with good air", &within);
    // By hand, hard work and a scrubber that takes nothing out.
    browser.press("#scenario", "by");
    browser.wait("the crew is free", "return [...document.querySelectorAll('#inputs label')].some(l => l.textContent === 'crew.activity' && !l.control.disabled)");
    browser.run("const l = [...document.querySelectorAll('#inputs label')].find(l => l.textContent === 'crew.activity').control; l.value = 7; l.oninput();");
    browser.click("button[aria-label='scrubber.efficiency: removes nothing']");
    browser.press("#speed", "× 1000");
    browser.wait("CO2 is too high", &format!("return {}.includes('too high')", row("CO2")));
    browser.wait(
        "it is said",
        "return document.querySelector('#news').textContent.includes('CO2 in cabin: too high')",
    );
    browser.wait("it is marked", "return document.querySelector('#n0').classList.contains('beyond')");
    plant.wait("cabin.carbon_dioxide", "above 399 Pa", |pressure| pressure > 399.0);
    plant.wait("scrubber.efficiency", "none", |efficiency| efficiency < 1e-6);
    // Its edge has another colour than that of a node within its limits.
    let edges = "const edge = id => getComputedStyle(document.querySelector(id + ' rect')).stroke; return edge('#n0') !== edge('#n4')";
    browser.wait("its edge is coloured", edges);
    for (unit, co2, temperature) in [("mmHg", "mmHg", "°F"), ("kPa", "kPa", "°C")] {
        browser.choose("#units", unit);
        browser.wait(
            unit,
            &format!(
                "return {}.includes('{co2}') && {}.includes('{temperature}')",
                row("CO2"),
                row("Dew point")
            ),
        );
        browser.wait(
            "in the drawing too",
            &format!("return document.querySelector('#n0b').textContent.includes('{temperature}')"),
        );
        browser.wait("and over the charts", &format!("return document.querySelector('#temperature-caption').textContent.includes('[{temperature}]')"));
    }
    browser.choose("#units", "mm");
    // A coolant's flow is no volume of air.
    let coolant =
        "return [...document.querySelectorAll('text')].filter(t => t.textContent.endsWith('lb/h')).length";
    browser.wait("coolant in pounds an hour", &format!("{coolant} === 3"));
    assert_quiet(&browser);
}

#[test]
fn a_valve_under_control_shows_it_and_fails_by_its_actuator() {
    let (plant, browser) = opened("thcs.toml");
    let controlled = "return [...document.querySelectorAll('#inputs span')].filter(s => s.textContent === 'follows its controller').length";
    browser.wait("two valves, a heater and two gases are controlled", &format!("{controlled} === 5"));
    browser.click("button[aria-label='che_valve.opening: open']");
    browser.wait(
        "both ways of the valve are marked",
        "return [...document.querySelectorAll('.element.broken')].map(e => e.getAttribute('aria-label')).sort().join() === 'valve bypass_valve,valve che_valve'",
    );
    browser.press("#speed", "× 10");
    browser.wait("it travels to its stop", "return [...document.querySelectorAll('.element.valve')].some(e => e.getAttribute('aria-label') === 'valve che_valve' && e.textContent.includes('100.0 %'))");
    plant.wait("bypass_valve.opening", "0.1", |opening| (opening - 0.1).abs() < 1e-3);
    browser.click("button[aria-label='che_valve.opening: open']");
    browser.wait("it is repaired", "return !document.querySelector('.element.broken')");
    // The sensor of the same loop, by its fault.
    browser.run("document.querySelectorAll('#inputs details').forEach(group => { group.open = true; })");
    browser.click("button[aria-label='cabin_temperature.sensor_fault: drops out']");
    browser.wait(
        "it is said",
        "return document.querySelector('#news').textContent === 'cabin_temperature.sensor_fault: drops out'",
    );
    plant.wait("cabin_temperature.sensor_fault", "2", |fault| (fault - 2.0).abs() < 1e-6);
    // A setpoint is typed in the unit shown.
    browser.run("const l = [...document.querySelectorAll('#inputs label')].find(l => l.textContent === 'cabin_temperature.setpoint').control; l.value = 21; l.onchange();");
    plant.wait("cabin_temperature.setpoint", "294.15 K", |setpoint| (setpoint - 294.15).abs() < 1e-3);
    assert_quiet(&browser);
}
