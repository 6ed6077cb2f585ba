//! Every kind of mistake is refused, at its line and column, with its reason.

use eclss_network_file::{FileError, limits, parse, parse_bytes};

/// A small network that is right; every test spoils it in one place.
const RIGHT: &str = r#"schema = 1
name = "small"
reference_pressure_pa = 101325.0

[run]
step = "1ms"
record = ["valve.mass_flow"]

[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 101325.0
temperature_k = 295.15

[[node]]
id = "outside"
kind = "boundary"
pressure_pa = 101000.0
temperature_k = 293.15

[[line]]
id = "duct"
from = "cabin"
to = "outside"

[[line.element]]
id = "filter"
kind = "pipe"
loss_coefficient = 2.0
diameter_m = 0.1
length_m = 0.5

[[line.element]]
id = "valve"
kind = "valve"
open_resistance_pa_s2_kg2 = 100.0
exponent = 2.0

[[line.element]]
id = "fan"
kind = "fan"
shutoff_pa = 300.0
quadratic_pa_s2_kg2 = 13000.0
speed = 0.5

[[schedule]]
input = "valve.opening"
points = [[0.0, 1.0], [1.0, 0.5]]
"#;

fn refused(text: &str) -> FileError {
    match parse(text, "small.toml") {
        Err(error) => error,
        Ok(_) => panic!("was accepted:\n{text}"),
    }
}

/// Replaces `old` by `new`; the file must be refused for `reason` where `new` has its mark `«`.
#[track_caller]
fn spoil(old: &str, new: &str, reason: &str) {
    assert_eq!(RIGHT.matches(old).count(), 1, "`{old}` must stand in the file once");
    let marked = RIGHT.replace(old, new);
    let byte = marked.find('«').expect("the new text has a mark");
    let text = marked.replace('«', "");
    let error = refused(&text);
    let line = text[..byte].matches('\n').count() + 1;
    let column = text[..byte].chars().rev().take_while(|&letter| letter != '\n').count() + 1;
    let found: Vec<_> = error.problems().iter().map(ToString::to_string).collect();
    let wanted = format!("small.toml:{line}:{column}: {reason}");
    assert!(found.iter().any(|problem| problem.starts_with(&wanted)), "wanted {wanted}\nfound  {found:#?}");
}

#[test]
fn the_file_itself_is_right() {
    assert!(parse(RIGHT, "small.toml").is_ok());
}

#[test]
fn what_is_not_toml() {
    spoil("schema = 1", "schema = «@", "not TOML");
    spoil("schema = 1\n", "schema = 1\n«schema = 1\n", "not TOML: duplicate key");
    let mut bytes = RIGHT.as_bytes().to_vec();
    bytes[11] = 0xff;
    let error = parse_bytes(&bytes, "small.toml").unwrap_err();
    assert_eq!(error.to_string(), "small.toml:2:1: not UTF-8 text");
}

#[test]
fn unknown_keys_and_kinds() {
    spoil("[run]", "title = «\"a\\u001b[2Jb\"\n[run]", "`title` has a control character");
    spoil("[run]", "title = «\"a\\nb\"\n[run]", "`title` has a control character");
    spoil("name =", "«nmae = 1\nname =", "unknown key `nmae`");
    spoil("step =", "«Step =", "unknown key `Step`");
    spoil("temperature_k = 295.15", "temperature_k = 295.15\n«mass_kg = 1.0", "unknown key `mass_kg`");
    spoil("to = \"outside\"", "to = \"outside\"\n«via = \"x\"", "unknown key `via`");
    spoil("speed = 0.5", "speed = 0.5\n«opening = 0.5", "unknown key `opening`");
    spoil("points =", "«pionts = 1\npoints =", "unknown key `pionts`");
    spoil("kind = \"boundary\"", "kind = «\"void\"", "`void` is not a kind that exists");
    spoil("kind = \"fan\"", "kind = «\"fna\"", "`fna` is not a kind that exists");
    spoil("[[schedule]]", "[[«pump]]\n[[schedule]]", "unknown key `pump`");
    let error = refused(&RIGHT.replace("speed = 0.5", "sped = 0.5"));
    assert_eq!(error.problems()[0].help.as_deref(), Some("did you mean `speed`?"));
}

#[test]
fn positions_in_drawings() {
    let place = |position: &str| format!("temperature_k = 295.15\nposition = {position}");
    spoil("temperature_k = 295.15", &place("«[1]"), "`position` is a pair of column and row");
    spoil("temperature_k = 295.15", &place("«7"), "`position` must be a list, not a number");
    spoil("temperature_k = 295.15", &place("[0, «64]"), "`position` must lie in 0 … 63, not at 64");
    spoil("temperature_k = 295.15", &place("[0, «nan]"), "`position` must be finite");
    spoil("temperature_k = 295.15", &place("[0, «\"a\"]"), "`position` must be a number, not text");
    spoil("temperature_k = 295.15", &place("«[0.5, 1]"), "`position` counts whole columns and rows");
    let twice = RIGHT.replace("temperature_k = 295.15", "temperature_k = 295.15\nposition = [2, 1]");
    let twice = twice.replace("temperature_k = 293.15", "temperature_k = 293.15\nposition = [2, 1]");
    assert!(refused(&twice).problems()[0].to_string().contains("node `cabin` stands there already"));
}

#[test]
fn missing_keys_and_tables() {
    spoil("schema = 1\nname = \"small\"\n", "«schema = 1\n", "`name` is missing");
    assert!(refused("").to_string().starts_with("small.toml:1:1: `schema` is missing"));
    spoil("[[node]]\nid = \"cabin\"\n", "«[[node]]\n", "`id` is missing");
    spoil("[[line]]\nid = \"duct\"\nfrom = \"cabin\"", "«[[line]]\nid = \"duct\"", "`from` is missing");
    spoil(
        "[[line.element]]\nid = \"fan\"\nkind = \"fan\"",
        "«[[line.element]]\nid = \"fan\"",
        "`kind` is missing",
    );
    spoil("points = [[0.0, 1.0], [1.0, 0.5]]", "points = «[]", "a schedule needs `points`");
    let only_node = &RIGHT[..RIGHT.find("[[line]]").unwrap()];
    assert!(refused(only_node).to_string().contains("there is no `[[line]]`"));
    let no_element = &RIGHT[..RIGHT.find("[[line.element]]").unwrap()];
    assert!(refused(no_element).to_string().contains("there is no `[[element]]`"));
    assert!(refused(&format!("{no_element}element = []")).to_string().contains("there is no `[[element]]`"));
}

#[test]
fn wrong_types() {
    spoil("volume_m3 = 60.0", "volume_m3 = «\"60\"", "`volume_m3` must be a number, not text");
    spoil("volume_m3 = 60.0", "volume_m3 = «true", "`volume_m3` must be a number, not true or false");
    spoil("name = \"small\"", "name = «5", "`name` must be text, not a number");
    spoil("record = [\"valve.mass_flow\"]", "record = [«1]", "a recorded point is text");
    spoil("[[0.0, 1.0], [1.0, 0.5]]", "[«0.0, 1.0]", "a point is a pair");
    spoil("[[0.0, 1.0], [1.0, 0.5]]", "[[0.0, 1.0], «[1.0]]", "a point is a pair");
    spoil("[run]", "[run]\nuntil = «26\n", "`until` must be text");
}

#[test]
fn numbers_that_are_no_numbers_or_too_large_or_too_small() {
    for word in ["nan", "-nan", "inf", "-inf"] {
        spoil("volume_m3 = 60.0", &format!("volume_m3 = «{word}"), "`volume_m3` must be finite");
    }
    spoil("volume_m3 = 60.0", "volume_m3 = «1e999", "`volume_m3` must be finite");
    spoil(
        "volume_m3 = 60.0",
        "volume_m3 = «99999999999999999999",
        "`volume_m3` is a number too large to read",
    );
    spoil("volume_m3 = 60.0", "volume_m3 = «1e300", "`volume_m3` must lie in");
    spoil("loss_coefficient = 2.0", "loss_coefficient = «1e-60", "`loss_coefficient` = 1e-60 does not fit");
    spoil("[1.0, 0.5]", "[1.0, «1e39]", "`value` = 1e39 does not fit single precision");
    spoil("[1.0, 0.5]", "[«nan, 0.5]", "`time` must be finite");
}

#[test]
fn values_out_of_range() {
    for (old, key) in [
        ("volume_m3 = 60.0", "volume_m3"),
        ("temperature_k = 295.15", "temperature_k"),
        ("pressure_pa = 101000.0", "pressure_pa"),
        ("loss_coefficient = 2.0", "loss_coefficient"),
        ("diameter_m = 0.1", "diameter_m"),
        ("length_m = 0.5", "length_m"),
        ("open_resistance_pa_s2_kg2 = 100.0", "open_resistance_pa_s2_kg2"),
        ("exponent = 2.0", "exponent"),
        ("shutoff_pa = 300.0", "shutoff_pa"),
        ("quadratic_pa_s2_kg2 = 13000.0", "quadratic_pa_s2_kg2"),
        ("speed = 0.5", "speed"),
        ("reference_pressure_pa = 101325.0", "reference_pressure_pa"),
    ] {
        spoil(old, &format!("{key} = «-1.0"), &format!("`{key}` must lie in"));
    }
    for (old, key) in [("volume_m3 = 60.0", "volume_m3"), ("temperature_k = 295.15", "temperature_k")] {
        spoil(old, &format!("{key} = «0.0"), &format!("`{key}` must lie in"));
    }
    let opening = "exponent = 2.0\nopening = «1.01";
    spoil("exponent = 2.0", opening, "`opening` must lie in 0 … 1, not at 1.01");
    spoil("[1.0, 0.5]", "«[1.0, -0.1]", "`opening` must lie in 0 … 1, not at -0.1");
    // In range each, but together they give a resistance that is not.
    spoil(
        "loss_coefficient = 2.0\ndiameter_m = 0.1",
        "loss_coefficient = «1e9\ndiameter_m = 1e-4",
        "`loss_coefficient` comes out",
    );
    // The closed valve must keep a finite resistance; this is the core's own rule.
    spoil(
        "open_resistance_pa_s2_kg2 = 100.0\nexponent = 2.0",
        "open_resistance_pa_s2_kg2 = «1e15\nexponent = 6.0\nleakage_opening = 1e-4",
        "`open_resistance_pa_s2_kg2` must be finite in single precision",
    );
}

#[test]
fn ids_that_are_none_or_taken() {
    spoil("id = \"cabin\"", "id = «\"Cabin\"", "`Cabin` is not an id");
    spoil("id = \"fan\"", "id = «\"fan.1\"", "`fan.1` is not an id");
    spoil("id = \"fan\"", "id = «\"\"", "`` is not an id");
    spoil("id = \"outside\"", "id = «\"cabin\"", "id `cabin` is taken already");
    spoil("id = \"fan\"", "id = «\"valve\"", "id `valve` is taken already");
    spoil("id = \"duct\"", "id = «\"cabin\"", "id `cabin` is taken already");
    let long = format!("id = «\"{}\"", "a".repeat(limits::ID_BYTES + 1));
    spoil("id = \"fan\"", &long, "`aaaa");
}

#[test]
fn references_that_lead_nowhere() {
    spoil("from = \"cabin\"", "from = «\"cabbin\"", "there is no node `cabbin`");
    spoil("to = \"outside\"", "to = «\"valve\"", "there is no node `valve`");
    let error = refused(&RIGHT.replace("to = \"outside\"", "to = \"cabin\""));
    assert_eq!(error.to_string(), "small.toml:17:6: no line reaches node `outside`");
    spoil("input = \"valve.opening\"", "input = «\"valve.speed\"", "there is no input `valve.speed`");
    spoil("[\"valve.mass_flow\"]", "[«\"valve.flow\"]", "there is no signal `valve.flow`");
    spoil("[\"valve.mass_flow\"]", "[\"fan.speed\", «\"fan.speed\"]", "`fan.speed` is recorded twice");
}

#[test]
fn schedules_that_do_not_fit() {
    spoil("[1.0, 0.5]", "[1.0, 0.5], «[0.5, 0.5]", "time 0.5 s lies before that of the point above it");
    spoil("[1.0, 0.5]", "[1.0, 0.5], [1.0, 0.6], «[1.0, 0.7]", "a third point at 1 s");
    spoil("[1.0, 0.5]", "[«-1.0, 0.5]", "`time` must lie in");
    spoil("points =", "interpolation = «\"cubic\"\npoints =", "`cubic` is not a interpolation that exists");
    let twice = "[[schedule]]\ninput = \"valve.opening\"\npoints = [[0.0, 1.0]]\n\n[[schedule]]\ninput = «\"valve.opening\"";
    spoil("[[schedule]]\ninput = \"valve.opening\"", twice, "`valve.opening` has a schedule already");
    spoil("exponent = 2.0", "exponent = 2.0\nopening = «1.0", "`valve.opening` follows a schedule");
}

#[test]
fn runs_that_cannot_be() {
    spoil("step = \"1ms\"", "step = «\"1\"", "`1`: a duration is a number and a unit");
    spoil("step = \"1ms\"", "step = «\"0s\"", "`step` must be longer than nothing");
    spoil(
        "step = \"1ms\"",
        "step = «\"1.5us\"",
        "`1.5us`: a duration must be a whole number of microseconds",
    );
    spoil("step = \"1ms\"", "step = «\"2h\"", "`step` is longer than an hour");
    spoil("step = \"1ms\"", "step = «\"1s\"", "step 1s is too long for method relaxation");
    spoil("step = \"1ms\"", "step = \"1ms\"\nmethod = «\"magic\"", "there is no method `magic`");
    let junction = "kind = «\"junction\"\n";
    spoil("kind = \"cabin\"\nvolume_m3 = 60.0\n", junction, "method relaxation takes no junction");
    spoil("volume_m3 = 60.0", "volume_m3 = «1e-6", "too small for method relaxation with step 1ms");
}

#[test]
fn junctions_that_nothing_holds() {
    let text = r#"
schema = 1
name = "floating"
reference_pressure_pa = 101325.0
[run]
method = "tr-bdf2"
[[node]]
id = "one"
kind = "junction"
pressure_pa = 101325.0
temperature_k = 295.15
[[node]]
id = "two"
kind = "junction"
pressure_pa = 101325.0
temperature_k = 295.15
[[line]]
id = "between"
from = "one"
to = "two"
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 100.0
"#;
    let error = refused(text).to_string();
    assert!(error.contains("nothing fixes the pressure of one, two"), "{error}");
}

#[test]
fn parameters_given_twice_or_half() {
    spoil("diameter_m = 0.1", "diameter_m = 0.1\narea_m2 = «0.01", "give the cross-section once");
    spoil("length_m = 0.5", "length_m = 0.5\ninertance_per_m = «60.0", "give the inertance once");
    spoil(
        "loss_coefficient = 2.0",
        "loss_coefficient = «2.0\nresistance_pa_s2_kg2 = 1.0",
        "give the loss once",
    );
    let without = "loss_coefficient = «2.0\n";
    spoil("loss_coefficient = 2.0\ndiameter_m = 0.1\n", without, "`loss_coefficient` needs a `diameter_m`");
    let without = "resistance_pa_s2_kg2 = 1.0\nlength_m = «0.5";
    let with = "loss_coefficient = 2.0\ndiameter_m = 0.1\nlength_m = 0.5";
    spoil(with, without, "`length_m` needs a `diameter_m`");
    let nothing = "«[[line.element]]\nid = \"filter\"\nkind = \"pipe\"\n";
    let all = "[[line.element]]\nid = \"filter\"\nkind = \"pipe\"\nloss_coefficient = 2.0\ndiameter_m = 0.1\nlength_m = 0.5\n";
    spoil(all, nothing, "give the loss once");
}

#[test]
fn lines_whose_flow_has_no_value_or_no_bounds() {
    let vacuum = RIGHT.replace(
        "kind = \"cabin\"\nvolume_m3 = 60.0\npressure_pa = 101325.0",
        "kind = \"boundary\"\npressure_pa = 0.0",
    );
    let error = refused(&vacuum);
    assert!(error.to_string().contains(":29:20: `loss_coefficient` needs a density"), "{error}");
    let density = "to = \"outside\"\nreference_density_kg_m3 = 1.2";
    let dense = vacuum.replace("to = \"outside\"", density);
    assert!(refused(&dense).to_string().contains("starts over more than 10 kPa"));
    let adaptive = dense.replace("[run]\n", "[run]\nmethod = \"adaptive\"\n");
    assert!(parse(&adaptive, "small.toml").is_ok());

    let elements = RIGHT.find("[[line.element]]").unwrap()..RIGHT.find("[[schedule]]").unwrap();
    let pipe = |resistance: &str| {
        let pipe = "[[line.element]]\nid = \"valve\"\nkind = \"pipe\"\nresistance_pa_s2_kg2 = ";
        let text = RIGHT.replace(&RIGHT[elements.clone()], &format!("{pipe}{resistance}\n"));
        text[..text.find("[[schedule]]").unwrap()].to_owned()
    };
    assert!(parse(&pipe("10.0"), "small.toml").is_ok());
    let error = refused(&pipe("0.0"));
    assert!(error.to_string().starts_with("small.toml:23:6: the line loses no pressure"), "{error}");
    let error = refused(&pipe("1e-6"));
    assert!(
        error.to_string().starts_with("small.toml:23:6: line `duct` would carry up to 18028 kg/s"),
        "{error}"
    );
}

/// The small network with another element in place of its valve.
const OPENING: &str = r#"schema = 1
name = "openings"
reference_pressure_pa = 101325.0

[run]
method = "adaptive"

[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 101325.0
temperature_k = 295.15

[[node]]
id = "space"
kind = "boundary"
pressure_pa = 0.0
temperature_k = 270.0

[[line]]
id = "out"
from = "cabin"
to = "space"
"#;

/// `element` after the small network; it must be refused for `reason` where it has its mark `«`.
#[track_caller]
fn spoil_opening(element: &str, reason: &str) {
    let marked = format!("{OPENING}\n[[line.element]]\nid = \"opening\"\n{element}\n");
    let byte = marked.find('«').expect("a mark");
    let text = marked.replace('«', "");
    let line = text[..byte].matches('\n').count() + 1;
    let found: Vec<_> = refused(&text).problems().iter().map(ToString::to_string).collect();
    let wanted = format!("small.toml:{line}:");
    let is_told = |problem: &String| problem.starts_with(&wanted) && problem.contains(reason);
    assert!(found.iter().any(is_told), "wanted {wanted} {reason}\nfound  {found:#?}");
}

#[test]
fn openings_and_valves_with_parameters_that_make_no_sense() {
    for (element, reason) in [
        ("kind = \"orifice\"\ndischarge_coefficient = «1.5\narea_m2 = 1e-4", "must lie in"),
        ("kind = \"orifice\"\ndischarge_coefficient = «0.0\narea_m2 = 1e-4", "must lie in"),
        ("kind = \"orifice\"\ndischarge_coefficient = «0.6", "needs a `diameter_m` or an `area_m2`"),
        ("kind = \"leak\"\nleak_kg_d = «-0.1\npressure_drop_pa = 101325.0", "must lie in"),
        (
            "kind = \"leak\"\nleak_kg_d = 0.1\npressure_drop_pa = «101326.0",
            "is more than the 101325 Pa before it",
        ),
        (
            "kind = \"leak\"\nleak_kg_d = «1e-9\npressure_drop_pa = 1e5\ninlet_pressure_pa = 1e7",
            "comes out as",
        ),
        (
            "kind = \"check_valve\"\nresistance_pa_s2_kg2 = 1e4\nreverse_leak_kg_s = «0.0\nreverse_pressure_pa = 1e3",
            "must lie in",
        ),
        (
            "kind = \"check_valve\"\nresistance_pa_s2_kg2 = «0.0\nreverse_leak_kg_s = 1e-6\nreverse_pressure_pa = 1e3",
            "must be above 0",
        ),
        (
            "kind = \"relief_valve\"\ncrack_pa = 3e3\nreseat_pa = «3e3\nresistance_pa_s2_kg2 = 1e6",
            "must lie below `crack_pa`",
        ),
        (
            "kind = \"relief_valve\"\ncrack_pa = «0.0\nreseat_pa = 0.0\nresistance_pa_s2_kg2 = 1e6",
            "must lie in",
        ),
        (
            "kind = \"relief_valve\"\ncrack_pa = 3e3\nreseat_pa = 1e3\nresistance_pa_s2_kg2 = «0.0",
            "must be above 0",
        ),
        (
            "kind = \"pressure_regulator\"\ndischarge_coefficient = 0.8\narea_m2 = 1e-4\nset_point_pa = 1e5\n\
             band_pa = «0.0\nlag_s = 1.0",
            "must lie in",
        ),
        (
            "kind = \"pressure_regulator\"\ndischarge_coefficient = 0.8\narea_m2 = 1e-4\nset_point_pa = 1e5\n\
             band_pa = 500.0\nlag_s = «0.0",
            "must lie in",
        ),
        ("kind = \"hatch\"\nloss_coefficient = 2.7\narea_m2 = 1.0\nleakage_opening = «0.0", "must lie in"),
        ("kind = \"hatch\"\nloss_coefficient = «0.0\narea_m2 = 1.0", "must be above 0"),
        ("kind = \"hatch\"\nloss_coefficient = 2.7\narea_m2 = 1.0\nopening = «2.0", "must lie in"),
    ] {
        spoil_opening(element, reason);
    }
}

#[test]
fn lines_that_respond_where_they_cannot() {
    let orifice = |id: &str| {
        format!(
            "[[line.element]]\nid = \"{id}\"\nkind = \"orifice\"\ndischarge_coefficient = 0.6\narea_m2 = 1e-6\n"
        )
    };
    let one = format!("{OPENING}{}", orifice("one"));
    assert!(parse(&one, "small.toml").is_ok());
    let text = one.replace("adaptive", "relaxation");
    assert!(
        refused(&text).to_string().contains("which method relaxation does not take"),
        "{}",
        refused(&text)
    );
    let text = format!("{one}{}", orifice("two"));
    let error = refused(&text).to_string();
    assert!(error.starts_with("small.toml:22:6: has several elements that need"), "{error}");
    let text = OPENING.replace("to = \"space\"", "to = \"space\"\ndensity = \"sometimes\"");
    let error = refused(&format!("{text}{}", orifice("one"))).to_string();
    assert!(error.contains("`sometimes` is not a density that exists"), "{error}");
    let vacuum = OPENING.replace(
        "from = \"cabin\"\nto = \"space\"",
        "from = \"space\"\nto = \"cabin\"\ndensity = \"follows\"",
    );
    let error = refused(&format!("{vacuum}{}", orifice("one"))).to_string();
    assert!(error.contains("`density` follows none"), "{error}");
}

#[test]
fn other_schema_versions() {
    spoil("schema = 1", "schema = «2", "schema 2 is not known, this version reads schema 1");
    spoil("schema = 1", "schema = «0.5", "schema 0.5 is not known");
}

#[test]
fn more_than_there_is_room_for() {
    let many = |count: usize, one: &dyn Fn(usize) -> String| (0..count).map(one).collect::<String>();
    let starts = |text: &str, reason: &str| {
        let error = refused(text).to_string();
        assert!(error.contains(reason), "{error}");
    };
    let node = |index| {
        format!(
            "[[node]]\nid = \"n{index}\"\nkind = \"boundary\"\npressure_pa = 1e5\ntemperature_k = 290.0\n"
        )
    };
    starts(&format!("{RIGHT}{}", many(limits::NODES, &node)), "16386 tables `[[node]]`, at most 16384");

    let point = |index| format!("[{index}.0, 0.5], ");
    let points = format!("points = [{}]", many(limits::SCHEDULE_POINTS + 1, &point));
    starts(&RIGHT.replace("points = [[0.0, 1.0], [1.0, 0.5]]", &points), "more than 65536 points");
    // Two schedules that fit alone and not together.
    let half = format!("points = [{}]", many(limits::SCHEDULE_POINTS / 2 + 1, &point));
    let two = RIGHT.replace("points = [[0.0, 1.0], [1.0, 0.5]]", &half).replace("speed = 0.5\n", "");
    let two = format!("{two}\n[[schedule]]\ninput = \"fan.speed\"\n{half}\n");
    starts(&two, "65538 points in all schedules");

    let element = |index| format!("{{id = \"e{index}\", kind = \"pipe\", resistance_pa_s2_kg2 = 1.0}}, ");
    let head = &RIGHT[..RIGHT.find("[[line.element]]").unwrap()];
    let text = format!("{head}element = [{}]\n", many(limits::ELEMENTS + 1, &element));
    starts(&text, "65537 tables `[[element]]`, at most 65536");

    starts(&format!("{RIGHT}{}", "#".repeat(limits::FILE_BYTES)), "bytes, at most 33554432 are allowed");
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once() {
    let text = RIGHT
        .replace("volume_m3 = 60.0", "volume_m3 = -60.0")
        .replace("kind = \"boundary\"", "kind = \"void\"")
        .replace("exponent = 2.0", "exponnt = 2.0")
        .replace("[1.0, 0.5]", "[1.0, nan]");
    let lines: Vec<_> = refused(&text).problems().iter().map(|problem| problem.line).collect();
    assert_eq!(lines, [12, 18, 34, 38, 49]);
}

/// Small wrong files are refused quickly: the first problems are listed, the others counted.
#[test]
fn problems_without_end_are_counted_and_not_all_told() {
    use eclss_network_file::limits::FINDINGS;
    let head = "schema = 1\nname = \"many\"\nreference_pressure_pa = 101325.0\n";
    let unknown: Vec<String> = (0..100_000).map(|index| format!("k{index} = 1\n")).collect();
    let unknown = unknown.concat();
    let empty = "[[node]]\n".repeat(16_000);
    for (text, least) in [(unknown, 100_000), (empty, 2 * 16_000)] {
        let error = parse(&format!("{head}{text}"), "many.toml").expect_err("it is wrong");
        assert_eq!(error.problems().len(), FINDINGS);
        assert!(error.more() + FINDINGS >= least, "{} more", error.more());
        // Each has its own place.
        let lines: Vec<usize> = error.problems().iter().map(|problem| problem.line).collect();
        assert!(lines.is_sorted() && lines[50] > 1, "{lines:?}");
    }
}
