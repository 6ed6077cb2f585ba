// Which charts a network has, and which curves are in them.

import { Chart } from "./trends.js";
import { flow, gauge, partial, pressure, ratio, temperature, trickle, write } from "./units.js";

const MOST_CURVES = 6;

/** Charts of what nodes publish beside pressure: quantity, title, unit. */
const OF_NODES = [
  ["temperature", "Temperature", temperature],
  ["dew_point", "Dew point", temperature],
  ["relative_humidity", "Relative humidity", ratio],
  ["carbon_dioxide", "Partial pressure of CO2", partial],
];

export class Charts {
  constructor(network, index) {
    this.network = network;
    this.index = index;
    this.condensers = network.values.filter((value) => value.id.endsWith(".condensate")).map((value) => value.id);
    this.nodes = OF_NODES.filter(([what]) => network.nodes.some((node) => index.has(`${node.id}.${what}`)));
    const names = ["flow", "pressure", ...this.nodes.map(([what]) => what), ...(this.condensers.length ? ["condensate"] : [])];
    this.charts = new Map(names.map((name) => [name, new Chart(name)]));
    document.getElementById("charts").replaceChildren(...[...this.charts.values()].map((chart) => chart.figure));
  }

  /** Draws what is chosen; `density(node)` gives the density at a node [kg/m³]. */
  draw(history, chosen, lines, density) {
    const { network, index } = this;
    const flows = [];
    const pressures = [];
    const nodes = network.nodes.filter((node) => chosen.has(node.id));
    nodes.forEach((node) => pressures.push({ label: node.id, place: index.get(`${node.id}.pressure`), of: gauge().of }));
    network.lines.forEach((line) => {
      const { of } = flow(density(line.from));
      const elements = line.elements.map(([id]) => id).filter((id) => chosen.has(id));
      const ids = [...(lines.has(line.id) ? [line.id] : []), ...elements];
      ids.forEach((id) => flows.push({ label: id, place: index.get(`${id}.mass_flow`), of }));
      elements.forEach((id) => pressures.push({ label: id, place: index.get(`${id}.outlet_pressure`), of: gauge().of }));
    });
    const set = (name, title, unit, curves) => {
      const chart = this.charts.get(name);
      chart.set(title, unit, curves.slice(-MOST_CURVES));
      chart.draw(history);
    };
    set("flow", "Mass flow", flow().unit, flows);
    set("pressure", `Pressure over ${write(network.reference_pa, pressure())}`, `${gauge().unit} gauge`, pressures);
    for (const [what, title, unit] of this.nodes) {
      const { of, unit: name } = unit();
      const published = nodes.filter((node) => index.has(`${node.id}.${what}`));
      set(what, title, name, published.map((node) => ({ label: node.id, place: index.get(`${node.id}.${what}`), of })));
    }
    if (this.condensers.length) {
      const { of, unit } = trickle();
      const curves = this.condensers.map((id) => ({ label: id.slice(0, id.lastIndexOf(".")), place: index.get(id), of }));
      set("condensate", "Condensate", unit, curves);
    }
  }
}
