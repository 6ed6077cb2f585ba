// Sliders, malfunctions, and the buttons that hold, step and choose.

import { unitFor, write } from "./units.js";
import { send } from "./stream.js";

const element = (id) => document.getElementById(id);

/** What an input's malfunctions are called. */
const names = (id) => id.endsWith(".opening")
  ? { stuck: "stuck", low: "shut", high: "open" }
  : id.endsWith(".speed")
    ? { stuck: "stuck", low: "stops", high: "runs away" }
    : { stuck: "stuck", low: "lowest", high: "highest" };
const STATES = { free: "", scheduled: "follows its schedule", stuck: "broken", low: "broken", high: "broken" };

export class Controls {
  constructor(network, say) {
    this.network = network;
    this.say = say;
    this.rows = network.inputs.map((input, number) => this.row(input, number));
    element("inputs").replaceChildren(...this.rows.map((row) => row.set));
    element("locked").hidden = network.control;
    element("scenario").replaceChildren(...network.scenarios.map((name, number) => new Option(name, String(number))));
    for (const id of ["pause", "step", "steps", "speed", "scenario"]) element(id).disabled = !network.control;
    element("filter").oninput = () => this.sift();
    element("pause").onclick = () => this.ask({ do: "pause", on: !this.paused });
    element("step").onclick = () => this.ask({ do: "step", steps: Math.max(1, Number(element("steps").value) || 1) });
    element("speed").onchange = (event) => this.ask({ do: "speed", factor: Number(event.target.value) });
    element("scenario").onchange = (event) => this.ask({ do: "scenario", number: Number(event.target.value) });
    this.states = network.inputs.map(() => "free");
    this.paused = false;
  }

  async ask(command) {
    const refused = await send(command);
    if (refused) this.say(refused);
  }

  row(input, number) {
    const set = document.createElement("fieldset");
    const head = document.createElement("div");
    head.className = "head";
    const label = document.createElement("label");
    label.textContent = input.id;
    label.htmlFor = `input-${number}`;
    const value = document.createElement("output");
    value.htmlFor = `input-${number}`;
    head.append(label, value);
    const slider = document.createElement("input");
    // What spans decades is typed, in SI units.
    const type = input.max - input.min > 1000 ? "number" : "range";
    Object.assign(slider, { type, id: `input-${number}`, min: input.min, max: input.max });
    slider.step = type === "range" ? (input.max - input.min) / 200 : "any";
    slider[type === "range" ? "oninput" : "onchange"] = () => {
      this.rows[number].held = performance.now();
      slider.setAttribute("aria-valuetext", write(Number(slider.value), unitFor(input.id, input.unit)));
      this.ask({ do: "set", input: number, value: Number(slider.value) });
    };
    const how = document.createElement("div");
    how.className = "how";
    // The ends of a range of decades are no malfunction that anyone has seen.
    const kinds = Object.entries(names(input.id)).filter(([kind]) => type === "range" || kind === "stuck");
    const buttons = kinds.map(([kind, name]) => {
      const button = document.createElement("button");
      Object.assign(button, { type: "button", textContent: name });
      button.setAttribute("aria-label", `${input.id}: ${name}`);
      button.onclick = () => this.ask({ do: "break", input: number, how: this.states[number] === kind ? null : kind });
      how.append(button);
      return [kind, button];
    });
    const state = document.createElement("span");
    how.append(state);
    set.append(head, slider, how);
    return { set, slider, value, buttons, state, held: -Infinity };
  }

  sift() {
    const wanted = element("filter").value.trim().toLowerCase();
    this.rows.forEach((row, number) => {
      row.set.hidden = !this.network.inputs[number].id.toLowerCase().includes(wanted);
    });
  }

  /** Brings the controls of an element into view; returns whether it has any. */
  reveal(id) {
    const number = this.network.inputs.findIndex((input) => input.id.startsWith(`${id}.`));
    if (number < 0) return false;
    element("filter").value = "";
    this.sift();
    this.rows[number].set.scrollIntoView({ block: "nearest" });
    return true;
  }

  show(frame, index) {
    const { figures } = frame;
    this.network.inputs.forEach((input, number) => {
      const row = this.rows[number];
      const state = frame.inputs[number] ?? "free";
      const value = frame.values[index.get(input.id)];
      if (state !== this.states[number] || row.first === undefined) {
        row.first = false;
        const was = this.states[number];
        this.states[number] = state;
        const locked = !this.network.control || state === "scheduled";
        row.slider.disabled = locked || state !== "free";
        for (const [kind, button] of row.buttons) {
          button.disabled = locked;
          button.setAttribute("aria-pressed", String(kind === state));
        }
        row.state.textContent = STATES[state] ?? state;
        const name = names(input.id)[state];
        if (name) this.say(`${input.id} is broken: ${name}`);
        else if (names(input.id)[was]) this.say(`${input.id} is repaired`);
      }
      const shown = write(value, unitFor(input.id, input.unit));
      if (row.value.textContent !== shown) row.value.textContent = shown;
      // While a hand is on the slider the plant does not move it.
      if (performance.now() - row.held > 500 && document.activeElement !== row.slider && Number.isFinite(value)) {
        row.slider.value = value;
        row.slider.setAttribute("aria-valuetext", shown);
      }
    });
    if (figures.paused !== this.paused) {
      this.paused = figures.paused;
      element("pause").textContent = this.paused ? "Run" : "Pause";
      element("pause").setAttribute("aria-pressed", String(this.paused));
      this.say(this.paused ? "the plant is held" : "the plant runs");
    }
    const chosen = String(figures.scenario);
    if (document.activeElement !== element("scenario")) element("scenario").value = chosen;
  }
}
