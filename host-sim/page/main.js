// Puts the page together: frames go to the drawing, the figures, the controls, the trends and the table.

import { Air } from "./air.js";
import { Charts } from "./charts.js";
import { Controls } from "./controls.js";
import { Drawing } from "./drawing.js";
import { writeAll } from "./figures.js";
import { Hardware } from "./hardware.js";
import { Recorder } from "./recorder.js";
import { ask, listen, load } from "./stream.js";
import { History, useSpan } from "./trends.js";
import { clock, density, show, unitFor, useUnits, write } from "./units.js";

const element = (id) => document.getElementById(id);
const say = (text) => { element("news").textContent = text; };

let page = null;

/** Everything that belongs to one network; made anew when the server comes back with another one. */
async function build() {
  const network = await load("/network", "json");
  await choices(network);
  page?.recorder.drop();
  const index = new Map(network.values.map((value, place) => [value.id, place]));
  document.title = `${network.title} – eclss-rt`;
  element("title").textContent = network.title;
  element("about").textContent = `${network.method} on ${network.plant}, network ${network.network_id}`;
  element("pseudo").hidden = !network.pseudo_time;
  const built = {
    network, index, shown: 0, rate: 0, since: performance.now(), count: 0, tabled: 0,
    history: new History(network.values.length),
    air: new Air(network, index, say),
    charts: new Charts(network, index),
    controls: new Controls(network, say),
    hardware: new Hardware(network),
    recorder: new Recorder(network, { button: element("record"), counter: element("recorded"), file: element("file") }, say),
    chosen: new Set([...network.nodes.filter((node) => node.kind === "cabin").slice(0, 3).map((node) => node.id)]),
    lines: new Set(network.lines.slice(0, 3).map((line) => line.id)),
    inlets: inlets(network),
    frame: null,
  };
  try {
    const text = await load("/schematic.svg", "text");
    built.drawing = new Drawing(element("drawing"), text, network, index, (id) => choose(built, id));
    built.drawing.mark(built.chosen);
    element("zoom").onchange = (event) => built.drawing.zoom(event.target.value);
    built.drawing.zoom(element("zoom").value);
  } catch {
    element("drawing").textContent = "This network is too large for a drawing; its values are below.";
  }
  element("table").replaceChildren(...network.values.map((value) => {
    const row = document.createElement("tr");
    const name = document.createElement("th");
    name.scope = "row";
    name.textContent = value.id;
    name.title = value.label;
    row.append(name, document.createElement("td"));
    return row;
  }));
  return built;
}

/** Offers the networks that the server offers. */
async function choices(network) {
  const names = await load("/networks", "json");
  const list = element("network");
  element("networks").hidden = names.length === 0;
  list.replaceChildren(...names.map((name, number) => new Option(number ? name : `${name.replace(/^copy of | inside this program$/g, "").split("/").slice(-2).join("/")} (given)`, String(number))));
  // The first is the one that was asked for when the server began; others come out of the program.
  list.value = String(Math.max(0, names.findIndex((name, number) => number > 0 && network.source === `copy of ${name} inside this program`)));
  if (network.source === names[0]) list.value = "0";
  list.onchange = async () => {
    const refused = await ask("/networks", { network: Number(list.value) });
    if (refused) say(refused);
  };
}

/** A node or element was chosen: its pressure or flow joins the trends or leaves them. */
function choose(built, id) {
  const is = built.chosen.has(id);
  if (is) built.chosen.delete(id); else built.chosen.add(id);
  built.drawing.mark(built.chosen);
  built.controls.reveal(id);
  const value = (name) => {
    const place = built.index.get(name);
    if (place === undefined || !built.frame) return "";
    const unit = unitOf(built, built.network.values[place], densityAt(built, built.frame));
    return `, ${name.slice(name.lastIndexOf(".") + 1).replaceAll("_", " ")} ${write(built.frame.values[place], unit)}`;
  };
  const said = ["mass_flow", "outlet_pressure", "opening", "speed", "temperature", "relative_humidity"].map((what) => value(`${id}.${what}`)).join("");
  say(`${id}${said}${is ? ": taken from the trends" : ": drawn in the trends"}`);
}

function densityAt(built, frame) {
  const { network, index } = built;
  return (node) => {
    const { id, kind, temperature_k: still } = network.nodes[node];
    if (kind === "liquid" || kind === "accumulator") return null;
    const over = frame.values[index.get(`${id}.pressure`)] ?? 0;
    const kelvin = frame.values[index.get(`${id}.temperature`)] ?? still;
    return density(network.reference_pa + over, kelvin);
  };
}

/** Node from which a line, or the line of an element, starts: its density is that of the flow. */
function inlets(network) {
  const found = new Map();
  for (const line of network.lines) {
    found.set(line.id, line.from);
    line.elements.forEach(([id]) => found.set(id, line.from));
  }
  return found;
}

/** The unit of a published value in the present frame. */
function unitOf(built, value, rho) {
  const inlet = built.inlets.get(value.id.slice(0, value.id.lastIndexOf(".")));
  return unitFor(value, inlet === undefined ? undefined : rho(inlet));
}

/** What makes figures of a node doubtful though the run goes on, in words. */
function doubtful(built, { figures: f }) {
  const node = built.network.nodes[f.warned_node];
  return node && f.warning ? `${node.id}: ${f.warning}` : "";
}

/** Where a run left its range and what did, in words. */
function wrong(built, { figures: f }) {
  const place = f.fault_node !== null ? built.network.nodes[f.fault_node] : built.network.lines[f.fault_line];
  return place && f.fault ? `: ${place.id}, ${f.fault}` : "";
}

function figures(built, frame) {
  const { figures: f } = frame;
  const us = (number) => `${show(number, number < 10 ? 2 : 0)} µs`;
  const closure = Number.isFinite(f.closure) && f.closure !== null ? f.closure.toExponential(1).replace("-", "−") : "–";
  const lines = [
    ["Plant time", clock(f.t_s)], ["Tick", String(f.tick)], ["Speed", f.paused ? "held" : `× ${f.speed}`],
    ["Overruns", f.overruns === null ? "–" : String(f.overruns), f.overruns > 0],
    ["Behind the clock", f.lag_s < 600 ? `${show(f.lag_s, 3)} s` : clock(f.lag_s)],
    ["Headroom", f.headroom === null ? "–" : `${show(f.headroom * 100, 1)} %`, f.headroom !== null && f.headroom < 0.2], ["Step, mean", us(f.mean_us)],
    ["Step, 99 %", us(f.p99_us)], ["Step, worst", us(f.worst_us)],
    ["φ now", show(f.phi, 4)], ["φ_min", show(f.phi_worst, 4)], ["Ledger lacks", closure],
    ["State", f.trusted ? "trusted" : "left its range", !f.trusted],
    ["Doubtful", doubtful(built, frame) || "–", Boolean(f.warning)],
    ["Frames dropped", String(frame.missed)], ["Updates", `${show(built.rate, 1)} /s`],
  ];
  writeAll(element("figures"), lines);
}

function table(built, frame) {
  const rows = element("table").children;
  const rho = densityAt(built, frame);
  built.network.values.forEach((value, place) => {
    const unit = unitOf(built, value, rho);
    rows[place].lastChild.textContent = write(frame.values[place], unit);
  });
}

function onFrame(frame) {
  const built = page;
  if (!built || frame.values.length !== built.network.values.length) return;
  const now = performance.now();
  built.frame = frame;
  built.count += 1;
  built.history.add(frame.figures.t_s, frame.values);
  built.recorder.add(frame);
  if (now - built.since >= 1000) {
    built.rate = (built.count * 1000) / (now - built.since);
    [built.count, built.since] = [0, now];
  }
  document.documentElement.dataset.frames = String((built.shown += 1));
  if (document.hidden) return;
  const rho = densityAt(built, frame);
  built.drawing?.show(frame, rho, built.air.show(frame));
  built.controls.show(frame, built.index);
  built.hardware.show(frame);
  figures(built, frame);
  if (built.shown % 4 === 1) built.charts.draw(built.history, built.chosen, built.lines, rho);
  if (now - built.tabled > 1000 && element("all").querySelector("details").open) {
    built.tabled = now;
    table(built, frame);
  }
  if (!frame.figures.trusted && built.trusted !== false) say(`the run left its range and is no longer trusted${wrong(built, frame)}`);
  built.trusted = frame.figures.trusted;
  const warning = doubtful(built, frame);
  if (warning && warning !== built.warning) say(warning);
  built.warning = warning;
}

async function onLink(live, known) {
  element("link").textContent = live ? "live" : "connection lost, trying again";
  element("link").className = live ? "live" : "lost";
  document.body.classList.toggle("stale", !live);
  if (live && known.lost) {
    // The server may have come back with another network.
    try {
      const network = await load("/network", "json");
      if (JSON.stringify(network) !== JSON.stringify(page?.network)) page = await build();
      known.lost = false;
    } catch { /* gone again: the next connection tries */ }
  } else if (!live) known.lost = true;
}

function view() {
  const remember = (key, value) => { try { localStorage.setItem(key, value); } catch { /* private windows may refuse */ } };
  const recall = (key) => { try { return localStorage.getItem(key) ?? ""; } catch { return ""; } };
  const theme = (name) => { document.documentElement.dataset.theme = name; };
  element("theme").value = recall("theme");
  theme(element("theme").value);
  element("theme").onchange = (event) => { theme(event.target.value); remember("theme", event.target.value); };
  element("span").onchange = (event) => useSpan(event.target.value);
  useSpan(element("span").value);
  element("units").value = recall("units") || "si";
  useUnits(element("units").value);
  element("units").onchange = (event) => { useUnits(event.target.value); remember("units", event.target.value); };
}

async function start() {
  view();
  const known = { lost: false };
  while (!page) {
    try { page = await build(); } catch { await new Promise((done) => { setTimeout(done, 500); }); }
  }
  listen(onFrame, (live) => onLink(live, known));
}

start();
