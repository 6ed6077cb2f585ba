// Curves of the last minute, drawn on a canvas.

import { show } from "./units.js";

const SPAN = 60; // s of plant time
const KEPT = 1600; // frames
const LOOKS = [[], [7, 4], [2, 3], [10, 3, 2, 3], [4, 2], [1, 2]];

/** All values of the last frames, so that a curve that is chosen has a past. */
export class History {
  constructor(width) { this.width = width; this.clear(); }

  clear() { this.times = []; this.rows = []; }

  add(time, values) {
    const last = this.times[this.times.length - 1];
    if (last !== undefined && time < last) this.clear();
    if (last !== undefined && time === last) return;
    this.times.push(time);
    this.rows.push(Float64Array.from(values, (value) => (value === null ? NaN : value)));
    if (this.times.length > KEPT) { this.times.shift(); this.rows.shift(); }
  }
}

/** One chart: `curves` are { label, place, of } with `of` turning a value into the unit shown. */
export class Chart {
  constructor(name) {
    this.canvas = document.getElementById(`${name}-chart`);
    this.caption = document.getElementById(`${name}-caption`);
    this.legend = document.getElementById(`${name}-legend`);
    this.curves = [];
  }

  set(title, unit, curves) {
    const key = JSON.stringify([title, unit, curves.map((curve) => curve.label)]);
    this.curves = curves;
    this.unit = unit;
    if (key === this.key) return;
    this.key = key;
    this.caption.textContent = `${title} [${unit}] over plant time [s]`;
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
    const end = times.length ? Math.max(times[times.length - 1], SPAN) : SPAN;
    const begin = end - SPAN;
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
    const x = (time) => left + ((time - begin) / SPAN) * (right - left);
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
    for (let tick = Math.ceil(begin / 10) * 10; tick <= end; tick += 10) {
      pen.beginPath(); pen.moveTo(x(tick), top); pen.lineTo(x(tick), bottom); pen.stroke();
      pen.fillText(String(tick), Math.min(x(tick), right - 8), bottom + 5);
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
