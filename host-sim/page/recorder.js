// Records what is shown, as comma-separated values with SI units: into a file of the server where it was started with
// a folder for them, else in this page, which saves it when it ends.

import { ask, load } from "./stream.js";

const MOST = 20_000_000; // values that a page keeps
const LOOK = 1000; // ms between two looks at the server's recording

export class Recorder {
  constructor(network, { button, counter, file }, say) {
    this.names = network.values.map((value) => value.id);
    this.rows = null;
    this.there = null;
    Object.assign(this, { button, counter, file, say });
    button.onclick = () => (this.there ? this.order() : this.toggle());
    this.state(false);
    this.look();
  }

  /** Follows the server's recording; without one the page records by itself. */
  async look() {
    let state = null;
    try { state = await load("/recording", "json"); } catch { /* it writes no files, or is gone */ }
    if (state) {
      const was = this.there;
      this.there = state;
      this.state(state.on);
      if (state.file) this.counter.textContent = `${state.file}: ${state.rows} rows${state.ended ? `, ${state.ended}` : ""}`;
      if (was?.on && !state.on) this.say(`${state.file} is written, ${state.rows} rows${state.ended ? `: ${state.ended}` : ""}`);
    }
    clearTimeout(this.timer);
    if (state) this.timer = setTimeout(() => this.look(), LOOK);
  }

  async order() {
    const refused = await ask("/recording", { file: this.there.on ? null : this.file.value });
    if (refused) this.say(refused);
    await this.look();
  }

  toggle() {
    if (this.rows) this.save(); else this.rows = [];
    this.state(Boolean(this.rows));
    this.counter.textContent = "";
  }

  state(on) {
    this.button.setAttribute("aria-pressed", String(on));
    this.button.textContent = on ? (this.there ? "Stop recording" : "Stop and save") : "Record";
    this.file.disabled = on;
  }

  /** Ends with its network. */
  drop() { clearTimeout(this.timer); }

  add(frame) {
    if (!this.rows) return;
    this.rows.push(`${frame.figures.t_s.toFixed(6)},${frame.figures.tick},${frame.values.map((value) => value ?? "").join(",")}`);
    this.counter.textContent = `${this.rows.length} rows`;
    if (this.rows.length * this.names.length >= MOST) this.button.click();
  }

  csv() { return `t_s,tick,${this.names.join(",")}\n${this.rows.join("\n")}\n`; }

  save() {
    const link = document.createElement("a");
    const file = URL.createObjectURL(new Blob([this.csv()], { type: "text/csv" }));
    const name = this.file.value.replace(/[^\w.-]+/g, "_").replace(/^\.+|\.csv$/g, "") || "eclss-rt";
    Object.assign(link, { href: file, download: `${name}.csv` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(file), 10_000);
    this.say(`${name}.csv is saved, ${this.rows.length} rows`);
    this.rows = null;
  }
}
