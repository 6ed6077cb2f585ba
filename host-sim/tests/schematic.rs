//! Drawings: nothing overlaps, by geometry, from one loop to a station of twelve modules.

use std::path::Path;

use crate::common::Folder;
use eclss_host_sim::schematic::{Drawing, Dress, Element, Graph, Line, Node, Style};
use eclss_network_file::generate::{Shape, generate};
use eclss_network_file::{NetworkFile, parse};

fn shipped() -> Vec<(String, NetworkFile)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let networks = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let mut list: Vec<_> = networks
        .filter_map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            // Scenarios and the like stand beside the networks.
            text.contains("[[node]]").then(|| {
                let name = path.display().to_string();
                let loaded = parse(&text, &name).unwrap_or_else(|error| panic!("{error}"));
                (name, loaded.file)
            })
        })
        .collect();
    list.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(list.len() >= 4, "{list:?}");
    list
}

#[track_caller]
fn assert_good(name: &str, graph: &Graph) -> Drawing {
    let drawing = Drawing::new(graph).unwrap_or_else(|error| panic!("{name}: {}", error.text(graph)));
    let found = drawing.collisions(graph);
    assert!(found.is_empty(), "{name}: {found:#?}");
    for dress in [Dress::File, Dress::Page] {
        let svg = drawing.svg(graph, dress);
        let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
        let texts: Vec<_> = document.descendants().filter_map(|node| node.text()).collect();
        for node in &graph.nodes {
            let start: String = node.id.chars().take(6).collect();
            assert!(texts.iter().any(|text| text.starts_with(&start)), "{name}: {} is not written", node.id);
        }
    }
    drawing
}

#[test]
fn the_networks_that_ship_are_drawn_without_overlap() {
    for (name, file) in shipped() {
        assert_good(&name, &Graph::of(&file));
    }
}

#[test]
fn generated_networks_up_to_twelve_modules_are_drawn_without_overlap() {
    let mut folded = 0;
    for shape in Shape::ALL {
        // Supply and exhaust come on top of the modules.
        for nodes in 3..=14 {
            for seed in 0..4 {
                let file = generate(shape, nodes, seed).unwrap();
                let name = format!("{} of {nodes}, seed {seed}", shape.name());
                let drawing = assert_good(&name, &Graph::of(&file));
                folded += usize::from(drawing.wires.iter().any(|wire| wire.len() > 4));
            }
        }
    }
    assert!(folded > 20, "the test has seen lines that bend");
}

/// The station that ships with two more modules, each ventilated there and back, and a rack loop of its own.
fn station_of_twelve() -> Graph {
    let (_, file) = shipped().into_iter().find(|(name, _)| name.ends_with("station.toml")).unwrap();
    let mut graph = Graph::of(&file);
    let element = |line: &str, kind: &str| Element {
        id: format!("{line}_{kind}"),
        label: kind.into(),
        kind: kind.into(),
        active: kind != "pipe",
    };
    for (module, at) in [("cupola", "node3"), ("laboratory2", "sm")] {
        let new = graph.nodes.len();
        let old = graph.nodes.iter().position(|node| node.id == at).unwrap();
        graph.nodes.push(Node { id: module.into(), kind: "cabin", remark: "30 m³".into(), position: None });
        let ways = [(format!("{at}_{module}"), old, new), (format!("{module}_{at}"), new, old)];
        for (id, from, to) in ways.into_iter().chain([(format!("{module}_rack_air"), new, new)]) {
            let elements = ["fan", "valve", "pipe"].map(|kind| element(&id, kind)).into();
            graph.lines.push(Line { id, from, to, elements });
        }
    }
    assert_eq!(graph.nodes.iter().filter(|node| node.kind == "cabin").count(), 12);
    graph
}

#[test]
fn a_station_of_twelve_modules_is_drawn_with_few_crossings() {
    let station = station_of_twelve();
    let drawing = assert_good("station of twelve", &station);
    let found = drawing.crossings();
    println!("{} x {} px, {found} crossings, {} lines", drawing.width, drawing.height, station.lines.len());
    // A page of 1440 px shows it at two thirds of its size or more, so type of 12 px at 8 px.
    assert!(drawing.width <= 2_100 && drawing.height <= 1_500, "{} x {}", drawing.width, drawing.height);
    assert!(2 * found <= station.lines.len(), "{found} crossings");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("schematic");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("twelve.svg"), drawing.svg(&station, Dress::File)).unwrap();
    for (name, most) in [("paper.toml", 0), ("thcs.toml", 2), ("station.toml", 14)] {
        let (_, file) = shipped().into_iter().find(|(path, _)| path.ends_with(name)).unwrap();
        let graph = Graph::of(&file);
        let found = assert_good(name, &graph).crossings();
        println!("{name}: {found} crossings");
        assert!(found <= most, "{name}: {found} crossings");
    }
}

fn graph(nodes: usize, lines: &[(usize, usize, &[&str])]) -> Graph {
    let node = |index: usize| Node {
        id: format!("a_node_with_a_long_name_{index}"),
        kind: if index % 3 == 2 { "junction" } else { "cabin" },
        remark: "60 m³".into(),
        position: None,
    };
    let line = |(index, (from, to, kinds)): (usize, &(usize, usize, &[&str]))| Line {
        id: format!("line_with_a_name_that_is_longer_than_its_strip_{index}"),
        from: *from,
        to: *to,
        elements: kinds
            .iter()
            .enumerate()
            .map(|(place, kind)| Element {
                id: format!("element_{index}_{place}_with_a_name"),
                label: format!("element_{index}_{place}_with_a_name"),
                kind: (*kind).into(),
                active: place % 2 == 0,
            })
            .collect(),
    };
    Graph {
        title: "Names & <kinds>".into(),
        nodes: (0..nodes).map(node).collect(),
        lines: lines.iter().enumerate().map(line).collect(),
    }
}

#[test]
fn long_lines_long_names_and_kinds_without_a_symbol_find_room() {
    let kinds =
        ["orifice", "check_valve", "relief_valve", "pressure_regulator", "hatch", "leak", "warp_coil"];
    let long = [&kinds[..], &kinds, &kinds].concat();
    let network = graph(
        6,
        &[
            (0, 1, &kinds),
            (1, 0, &["pump"]),
            (1, 2, &long),
            (2, 3, &[]),
            (3, 3, &kinds[..1]),
            (3, 3, &long),
            (4, 5, &kinds[..2]),
        ],
    );
    assert_good("kinds", &network);
    let svg = Drawing::new(&network).unwrap().svg(&network, Dress::File);
    assert!(svg.contains(">warp_coil</text>") && svg.contains("Names &amp; &lt;kinds&gt;"), "{svg}");
    assert_good("one node", &graph(1, &[(0, 0, &kinds)]));
    assert_good("twenty lines between two", &graph(2, &[(0, 1, &["pipe", "valve"][..]); 20]));
    assert_good("twenty loops at one", &graph(1, &[(0, 0, &["fan", "valve"][..]); 20]));
}

#[test]
fn positions_of_the_file_are_kept_and_the_same_network_gives_the_same_drawing() {
    let mut network = graph(7, &[(0, 1, &["pipe"]), (1, 2, &["fan"]), (3, 4, &["bed"]), (5, 6, &["valve"])]);
    for (node, place) in [(0, (5, 0)), (1, (0, 9)), (2, (2, 0))] {
        network.nodes[node].position = Some(place);
    }
    let drawing = assert_good("positions", &network);
    let at = |node: usize| drawing.nodes[node].rect;
    assert!(at(1).x < at(2).x && at(2).x < at(0).x, "columns in their order");
    assert!(at(0).y < at(1).y && at(2).y < at(1).y, "rows in their order");
    assert_eq!(drawing, Drawing::new(&network).unwrap());
}

#[test]
fn a_larger_network_is_drawn_and_one_that_is_too_large_is_refused() {
    let file = generate(Shape::Mesh, 36, 1).unwrap();
    let drawing = assert_good("mesh of 36", &Graph::of(&file));
    assert_eq!(drawing.style, Style::NARROW);
    let folder = Folder::new("schematic");
    std::fs::write(folder.path("large.toml"), generate(Shape::Star, 300, 1).unwrap().to_toml()).unwrap();
    let (code, _, err) = folder.say(&["schematic", "large.toml"]);
    assert!(code == 1 && err.contains("300 nodes are too many"), "{err}");
    let (code, out, err) = folder.say(&["schematic", "-o", "paper.svg"]);
    assert!(code == 0 && out.contains("paper.svg"), "{err}");
    let svg = std::fs::read_to_string(folder.path("paper.svg")).unwrap();
    assert!(svg.contains("<style>") && svg.contains(">valve</text>"), "{svg}");
}
