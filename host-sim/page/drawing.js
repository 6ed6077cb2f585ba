// The schematic: values into its texts, arrows along its lines, colours by state and by φ.

import { gauge, flow, pressure, ratio, temperature, unitFor, write } from "./units.js";

const SPACING = 64; // px between arrows
const FASTEST = 90; // px/s of the largest flow
const PAINT = 50; // ms between two pictures

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class Drawing {
  /** `text`: the SVG; `choose(id)`: called when a node or element is chosen. */
  constructor(place, text, network, index, choose) {
    const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
    this.svg = document.importNode(parsed.documentElement, true);
    place.replaceChildren(this.svg);
    [this.width, this.height] = this.svg.getAttribute("viewBox").split(" ").slice(2).map(Number);
    // A large drawing takes the whole width; a small one is not blown up beyond reason.
    document.querySelector("main").classList.toggle("wide", this.width > 1100);
    this.zoom("");
    this.network = network;
    this.index = index;
    this.find = (id) => this.svg.getElementById(id);
    let first = 0;
    this.lines = network.lines.map((line, number) => {
      const own = this.line(number, line.elements.map((_, place) => this.find(`e${first + place}`)));
      first += line.elements.length;
      return own;
    });
    network.nodes.forEach((node, number) => {
      // Two lines of type stand in the middle of a box that has room for three.
      if (index.has(`${node.id}.temperature`) || node.kind === "junction") return;
      this.find(`n${number}`).querySelectorAll("text").forEach((text) => text.setAttribute("dy", "7"));
    });
    this.largest = 1e-9;
    this.groups = new Map();
    let element = 0;
    network.nodes.forEach((node, number) => this.groups.set(node.id, this.find(`n${number}`)));
    for (const line of network.lines) {
      for (const [id] of line.elements) this.groups.set(id, this.find(`e${element++}`));
    }
    for (const [id, group] of this.groups) {
      group.addEventListener("click", () => choose(id));
      group.addEventListener("keydown", (event) => {
        if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(id); }
      });
    }
    this.painted = 0;
    this.stopped = false;
    const paint = (now) => {
      if (now - this.painted >= PAINT && !document.hidden) this.move(now);
      requestAnimationFrame(paint);
    };
    requestAnimationFrame(paint);
  }

  /** Fits the drawing into the page, or shows it at a scale. */
  zoom(scale) {
    const { style } = this.svg;
    style.width = scale ? `${this.width * Number(scale)}px` : "";
    style.maxWidth = scale ? "none" : `${this.width * 1.6}px`;
    style.maxHeight = scale ? "none" : "";
  }

  /** The way of a line, its stretches and what of them lies under symbols. */
  line(number, symbols) {
    const wire = this.find(`l${number}`);
    const points = wire.getAttribute("d").match(/-?\d+ -?\d+/g).map((pair) => pair.split(" ").map(Number));
    const parts = [];
    let length = 0;
    for (let k = 1; k < points.length; k += 1) {
      const [[x, y], [u, v]] = [points[k - 1], points[k]];
      const long = Math.abs(u - x) + Math.abs(v - y);
      parts.push({ from: length, long, x, y, dx: Math.sign(u - x), dy: Math.sign(v - y), covered: [] });
      length += long;
    }
    for (const group of symbols) {
      const { a, d, e, f } = group.querySelector(".symbol").transform.baseVal.consolidate().matrix;
      const half = Math.max(Math.abs(a), Math.abs(d));
      for (const part of parts) {
        const along = (e - part.x) * part.dx + (f - part.y) * part.dy;
        const aside = Math.abs((e - part.x) * part.dy) + Math.abs((f - part.y) * part.dx);
        if (aside < 1 && along >= 0 && along <= part.long) part.covered.push([along - half, along + half]);
      }
    }
    return { wire, arrows: this.find(`l${number}a`), text: this.find(`l${number}f`), parts, length, phase: 0, flow: 0 };
  }

  mark(chosen) {
    for (const [id, group] of this.groups) {
      group.classList.toggle("chosen", chosen.has(id));
      group.setAttribute("aria-pressed", String(chosen.has(id)));
    }
  }

  /** Shows a frame; `density(node)` gives the density at a node [kg/m³], `beyond` the ids of nodes beyond a limit. */
  show(frame, density, beyond) {
    const { network, index } = this;
    const at = (id) => { const place = index.get(id); return place === undefined ? null : frame.values[place]; };
    const put = (id, text) => { const place = this.find(id); if (place && place.textContent !== text) place.textContent = text; };
    const { fault_node: badNode, fault_line: badLine } = frame.figures;
    network.nodes.forEach((node, number) => {
      const over = at(`${node.id}.pressure`);
      put(`n${number}a`, over === null ? "" : write(network.reference_pa + over, pressure()));
      const kelvin = at(`${node.id}.temperature`);
      const damp = at(`${node.id}.relative_humidity`);
      const parts = [];
      if (kelvin !== null) parts.push(write(kelvin, temperature()));
      if (damp !== null) parts.push(write(damp, ratio()));
      put(`n${number}b`, parts.join(" "));
      const group = this.find(`n${number}`);
      group.classList.toggle("fault", badNode === number);
      group.classList.toggle("beyond", beyond.has(node.id));
      group.style.setProperty("--slowed", bent(at(`${node.id}.phi`) ?? 1));
    });
    const states = new Map(network.inputs.map((input, k) => [input.id, frame.inputs[k]]));
    const inputs = new Map(network.inputs.map((input) => [input.id.slice(0, input.id.lastIndexOf(".")), input]));
    let largest = 1e-9;
    let element = 0;
    network.lines.forEach((line, number) => {
      const own = this.lines[number];
      const value = at(`${line.id}.mass_flow`);
      own.flow = Number.isFinite(value) && value !== null ? value : 0;
      largest = Math.max(largest, Math.abs(own.flow));
      put(`l${number}f`, write(value, flow(density(line.from))));
      own.wire.style.setProperty("--slowed", bent(at(`${line.id}.phi`) ?? 1));
      own.wire.classList.toggle("fault", badLine === number);
      for (const [id] of line.elements) {
        const input = inputs.get(id);
        const broken = input && !["free", "scheduled", "controlled"].includes(states.get(input.id));
        this.find(`e${element}`).classList.toggle("broken", Boolean(broken));
        put(`e${element}a`, input ? write(at(input.id), unitFor(input)) : "");
        const outlet = at(`${id}.outlet_pressure`);
        put(`e${element}b`, outlet === null ? "" : write(outlet, gauge()));
        element += 1;
      }
    });
    this.largest = largest;
    this.stopped = frame.figures.paused || !frame.figures.trusted;
  }

  /** Moves the arrows. */
  move(now) {
    const passed = Math.min(now - this.painted, 200) * 1e-3;
    this.painted = now;
    for (const line of this.lines) {
      const part = Math.abs(line.flow) / this.largest;
      if (part < 1e-6) { line.arrows.setAttribute("d", ""); continue; }
      const forward = Math.sign(line.flow);
      if (!this.stopped && !calm.matches) line.phase += forward * FASTEST * part * passed;
      const size = 3 + 4 * Math.sqrt(part);
      line.arrows.setAttribute("d", arrows(line, ((line.phase % SPACING) + SPACING) % SPACING, size, forward));
    }
  }
}

/** How far towards "fully bent" a φ is drawn. It spans decades: a tenth is more than half way. */
const bent = (phi) => `${phi >= 1 ? 0 : Math.round(Math.min(1, 0.1 - Math.log10(Math.max(phi, 1e-9)) / 2) * 100)}%`;

/** Triangles along a line, every `SPACING`; none where it would lie under a symbol or stick out at a bend. */
function arrows(line, phase, size, forward) {
  let path = "";
  for (const part of line.parts) {
    const skip = (((phase - part.from) % SPACING) + SPACING) % SPACING;
    for (let s = skip; s < part.long; s += SPACING) {
      if (s < size || s > part.long - size) continue;
      if (part.covered.some(([begin, end]) => s > begin - size && s < end + size)) continue;
      const [dx, dy] = [part.dx * forward, part.dy * forward];
      const [x, y] = [part.x + part.dx * s, part.y + part.dy * s];
      const [tx, ty] = [x + dx * size, y + dy * size];
      const [bx, by] = [x - dx * size, y - dy * size];
      const [wx, wy] = [-dy * size * 0.7, dx * size * 0.7];
      path += `M${tx.toFixed(1)} ${ty.toFixed(1)}L${(bx + wx).toFixed(1)} ${(by + wy).toFixed(1)}L${(bx - wx).toFixed(1)} ${(by - wy).toFixed(1)}Z`;
    }
  }
  return path;
}
