// What people breathe in a cabin, against the limits of their comfort and safety.

import { partial, pressure, ratio, temperature, trickle, write } from "./units.js";

const element = (id) => document.getElementById(id);
const MMHG = 133.322387415; // Pa

/**
 * Limits, each [least, most] in SI units. Temperature, humidity, total pressure and CO2 (there the mean of an hour):
 * NASA-STD-3001 vol. 2, quoted second hand. Dew point and oxygen: of the ISS's class, unverified.
 */
const QUANTITIES = [
  ["pressure", "Total pressure, absolute", pressure, [34.5e3, 103e3]],
  ["temperature", "Temperature", temperature, [291.15, 300.15]],
  ["dew_point", "Dew point", temperature, [277.55, 288.75]],
  ["relative_humidity", "Relative humidity", ratio, [0.25, 0.75]],
  ["oxygen", "O2", partial, [19.5e3, 23.1e3]],
  ["carbon_dioxide", "CO2", partial, [null, 3 * MMHG]],
];

export class Air {
  /** Shows itself where a network publishes the air of a cabin. */
  constructor(network, index, say) {
    this.network = network;
    this.index = index;
    this.say = say;
    const holds = (node) => index.has(`${node.id}.carbon_dioxide`) && index.has(`${node.id}.relative_humidity`);
    this.rooms = network.nodes.filter((node) => node.kind === "cabin" && holds(node));
    element("air").hidden = this.rooms.length === 0;
    element("room").replaceChildren(...this.rooms.map((node) => new Option(node.id, node.id)));
    element("room").onchange = () => { this.was = new Map(); };
    const ending = (end) => network.values.map((value, place) => [value.id, place]).filter(([id]) => id.endsWith(end));
    this.condensate = ending(".condensate").map(([, place]) => place);
    this.was = new Map();
    this.rows = this.lines().map(([, name]) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = name;
      const [value, limit] = [0, 1].map(() => document.createElement("td"));
      const state = document.createElement("strong");
      const range = document.createElement("span");
      limit.append(range, " ", state);
      row.append(head, value, limit);
      return { row, value, limit: range, state };
    });
    element("air-rows").replaceChildren(...this.rows.map(({ row }) => row));
  }

  lines() {
    const lines = [...QUANTITIES];
    if (this.condensate.length) lines.push(["condensate", "Condensate of all condensers", trickle, [null, null]]);
    return lines;
  }

  /** A quantity of a room [SI]; pressure is absolute. */
  value(frame, room, what) {
    if (what === "condensate") return this.condensate.reduce((sum, place) => sum + (frame.values[place] ?? 0), 0);
    const value = frame.values[this.index.get(`${room}.${what}`)];
    return value === null || value === undefined ? NaN : value + (what === "pressure" ? this.network.reference_pa : 0);
  }

  /** Shows the chosen room; returns its id where a limit is exceeded. Others may be ducts, where nobody breathes. */
  show(frame) {
    const out = new Set();
    const chosen = element("room").value;
    for (const { id } of this.rooms.filter((room) => room.id === chosen)) {
      this.lines().forEach(([what, name, unit, [least, most]], number) => {
        const value = this.value(frame, id, what);
        const low = least !== null && value < least;
        const high = most !== null && value > most;
        if (low || high) out.add(id);
        const row = this.rows[number];
        const shown = unit();
        const text = (cell, words) => { if (cell.textContent !== words) cell.textContent = words; };
        text(row.value, write(value, shown));
        const bare = { ...shown, unit: "", fixed: false };
        text(row.limit, least !== null ? `${write(least, bare)} … ${write(most, bare)}` : most !== null ? `≤ ${write(most, bare)}` : "");
        const state = low ? "too low" : high ? "too high" : "";
        text(row.state, state);
        row.row.classList.toggle("bad", Boolean(state));
        const was = this.was.get(what);
        if (was !== undefined && was !== state) this.say(`${name} in ${id}: ${state || "within its limits again"}`);
        this.was.set(what, state);
      });
    }
    return out;
  }
}
