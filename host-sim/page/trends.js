// Curves of the last minute, hour or day, drawn on a canvas.

import { show } from "./units.js";

const KEPT = 1600; // frames in a span, so that a day takes no more memory than a minute
/** Spans [s of plant time] with the unit of their axis: name, its length [s], from mark to mark. */
const SPANS = { 60: ["s", 1, 10], 600: ["min", 60, 1], 3600: ["min", 60, 10], 86400: ["h", 3600, 4] };

let span = 60;
export const useSpan = (seconds) => { span = SPANS[seconds] ? Number(seconds) : 60; };
const LOOKS = [[], [7, 4], [2, 3], [10, 3, 2, 3], [4, 2], [1, 2]];

/** All values of the last frames, so that a curve that is chosen has a past. */
export class History {
  constructor(width) { this.width = width; this.clear(); }

  clear() { this.times = []; this.rows = []; }

  add(time, values) {
    const last = this.times[this.times.length - 1];
    if (last !== undefined && time < last) this.clear();
    // What lies closer than a picture can show is left out; the newest frame is always there.
    const before = this.times[this.times.length - 2];
    if (last !== undefined && (time === last || (before !== undefined && time - before < span / KEPT))) {
      this.times.pop();
      this.rows.pop();
    }
    this.times.push(time);
    this.rows.push(Float64Array.from(values, (value) => (value === null ? NaN : value)));
    while (this.times.length > 2 * KEPT || this.times[1] < time - span) { this.times.shift(); this.rows.shift(); }
  }
}

/** One chart: `curves` are { label, place, of } with `of` turning a value into the unit shown. */
export class Chart {
  constructor(name) {
    const made = (kind, id) => Object.assign(document.createElement(kind), { id: `${name}-${id}` });
    this.figure = document.createElement("figure");
    this.canvas = made("canvas", "chart");
    this.canvas.setAttribute("role", "img");
    this.caption = made("figcaption", "caption");
    this.legend = made("ul", "legend");
    this.legend.className = "legend";
    this.figure.append(this.caption, this.canvas, this.legend);
    this.curves = [];
  }

  set(title, unit, curves) {
    const [name] = SPANS[span];
    const key = JSON.stringify([title, unit, name, curves.map((curve) => curve.label)]);
    this.curves = curves;
    this.unit = unit;
    if (key === this.key) return;
    this.key = key;
    this.caption.textContent = `${title} [${unit}] over plant time [${name}]`;
    this.legend.replaceChildren(...curves.map((curve, number) => {
      const item = document.createElement("li");
      const stroke = document.createElement("b");
      stroke.style.borderTopColor = `var(--c${number % 6})`;
      stroke.style.borderTopStyle = number % 6 === 0 ? "solid" : number % 2 ? "dashed" : "dotted";
      item.append(stroke, curve.label);
      return item;
    }));
  }

  draw(history) {
    const { canvas } = this;
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
    if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
    const pen = canvas.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    const { times, rows } = history;
    const end = times.length ? Math.max(times[times.length - 1], span) : span;
    const begin = end - span;
    let first = 0;
    while (first < times.length && times[first] < begin) first += 1;
    let [low, high] = [Infinity, -Infinity];
    for (const curve of this.curves) {
      for (let k = first; k < rows.length; k += 1) {
        const value = curve.of(rows[k][curve.place]);
        if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
      }
    }
    if (low > high) [low, high] = [0, 1];
    const room = Math.max((high - low) * 0.08, Math.abs(high) * 1e-4, 1e-3);
    [low, high] = [low - room, high + room];
    const [left, right, top, bottom] = [62, width - 8, 6, height - 20];
    const x = (time) => left + ((time - begin) / span) * (right - left);
    const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
    pen.font = "11px system-ui, sans-serif";
    pen.lineWidth = 1;
    pen.fillStyle = colour("--soft");
    pen.strokeStyle = colour("--edge");
    pen.setLineDash([]);
    const step = nice((high - low) / 4);
    const digits = Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)));
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let level = Math.ceil(low / step) * step; level <= high; level += step) {
      pen.beginPath(); pen.moveTo(left, y(level)); pen.lineTo(right, y(level)); pen.stroke();
      pen.fillText(show(level, digits), left - 6, y(level));
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const [, long, every] = SPANS[span];
    for (let tick = Math.ceil(begin / long / every) * every * long; tick <= end; tick += every * long) {
      pen.beginPath(); pen.moveTo(x(tick), top); pen.lineTo(x(tick), bottom); pen.stroke();
      pen.fillText(String(Math.round(tick / long)), Math.min(x(tick), right - 8), bottom + 5);
    }
    this.curves.forEach((curve, number) => {
      pen.strokeStyle = colour(`--c${number % 6}`);
      pen.lineWidth = 2;
      pen.setLineDash(LOOKS[number % 6]);
      pen.beginPath();
      let down = false;
      for (let k = Math.max(0, first - 1); k < rows.length; k += 1) {
        const value = curve.of(rows[k][curve.place]);
        if (!Number.isFinite(value)) { down = false; continue; }
        const place = [Math.max(x(times[k]), left), y(value)];
        if (down) pen.lineTo(...place); else pen.moveTo(...place);
        down = true;
      }
      pen.stroke();
    });
    const last = rows[rows.length - 1];
    const said = last ? this.curves.map((curve) => `${curve.label} ${show(curve.of(last[curve.place]), 2)} ${this.unit}`) : [];
    canvas.setAttribute("aria-label", `${this.caption.textContent}: ${said.join(", ") || "nothing yet"}`);
  }
}

function nice(step) {
  const decade = 10 ** Math.floor(Math.log10(step));
  const part = step / decade;
  return decade * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10);
}
