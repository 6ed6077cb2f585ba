// Sliders, malfunctions, and the buttons that hold, step and choose.

import { back, unitFor, write } from "./units.js";
import { send } from "./stream.js";

const element = (id) => document.getElementById(id);

/** What an input's malfunctions are called; where an end of its range is none that anyone has seen, it is left out. */
const MALFUNCTIONS = {
  opening: { stuck: "stuck", low: "shut", high: "open" },
  speed: { stuck: "stuck", low: "stops", high: "runs away" },
  separator_efficiency: { low: "carries water over" },
  efficiency: { low: "removes nothing" },
  air_flow: { low: "blocked" },
  coolant_flow: { stuck: "stuck", low: "stops" },
  power: { stuck: "stuck" },
};
const malfunctions = (id) => MALFUNCTIONS[id.slice(id.lastIndexOf(".") + 1)] ?? {};
/** Inputs that say by a number what is wrong with a sensor or an actuator. */
const FAULTS = { sensor_fault: ["none", "stuck", "drops out"], actuator_fault: ["none", "stuck", "open", "closed"] };
const STATES = {
  free: "", scheduled: "follows its schedule", controlled: "follows its controller", stuck: "broken", low: "broken", high: "broken",
};
const BROKEN = new Set(["stuck", "low", "high"]);
/** A thing with so many inputs shows them when it is asked to. */
const MANY = 3;

export class Controls {
  constructor(network, say) {
    this.network = network;
    this.say = say;
    this.rows = network.inputs.map((input, number) => this.row(input, number));
    this.groups = this.grouped();
    element("inputs").replaceChildren(...this.groups.map((group) => group.shell));
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

  /** The inputs of one thing together, folded where they are many. */
  grouped() {
    const groups = [];
    this.network.inputs.forEach(({ id }, number) => {
      const owner = id.slice(0, id.lastIndexOf("."));
      if (groups.at(-1)?.owner !== owner) groups.push({ owner, rows: [] });
      groups.at(-1).rows.push(this.rows[number]);
    });
    for (const group of groups) {
      const folded = group.rows.length >= MANY;
      group.shell = document.createElement(folded ? "details" : "div");
      if (folded) {
        const summary = document.createElement("summary");
        summary.textContent = `${group.owner} (${group.rows.length})`;
        group.shell.append(summary);
      }
      group.shell.append(...group.rows.map((row) => row.set));
    }
    return groups;
  }

  /** Buttons for an input that says by its number what is wrong. */
  fault(input, number, words) {
    const set = document.createElement("fieldset");
    const head = document.createElement("legend");
    head.textContent = input.id;
    const how = document.createElement("div");
    how.className = "how";
    const buttons = words.map((word, code) => {
      const button = document.createElement("button");
      Object.assign(button, { type: "button", textContent: word });
      button.classList.toggle("whole", code === 0);
      button.setAttribute("aria-label", `${input.id}: ${word}`);
      button.onclick = () => this.ask({ do: "set", input: number, value: code });
      how.append(button);
      return button;
    });
    set.append(head, how);
    return { set, faults: buttons };
  }

  row(input, number) {
    const faults = FAULTS[input.id.slice(input.id.lastIndexOf(".") + 1)];
    if (faults) return this.fault(input, number, faults);
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
    // What spans decades is typed, in the unit shown.
    const typed = input.max - input.min > 1000 || input.unit === "kg/s" && input.min < 0 || input.unit === "m³/s";
    const unit = () => unitFor(input);
    Object.assign(slider, { type: typed ? "number" : "range", id: `input-${number}` });
    if (!typed) Object.assign(slider, { min: input.min, max: input.max });
    const whole = input.id.endsWith(".count") || input.id.endsWith(".activity");
    slider.step = typed ? "any" : whole ? 1 : (input.max - input.min) / 200;
    slider[typed ? "onchange" : "oninput"] = () => {
      this.rows[number].held = performance.now();
      const wanted = typed ? back(Number(slider.value), unit()) : Number(slider.value);
      if (slider.value === "" || !Number.isFinite(wanted)) return;
      slider.setAttribute("aria-valuetext", write(wanted, unit()));
      this.ask({ do: "set", input: number, value: Math.min(Math.max(wanted, input.min), input.max) });
    };
    const how = document.createElement("div");
    how.className = "how";
    const buttons = Object.entries(malfunctions(input.id)).map(([kind, name]) => {
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
    return { set, slider, typed, value, buttons, state, held: -Infinity };
  }

  sift() {
    const wanted = element("filter").value.trim().toLowerCase();
    this.rows.forEach((row, number) => {
      row.set.hidden = !this.network.inputs[number].id.toLowerCase().includes(wanted);
    });
    for (const { shell, rows } of this.groups) {
      shell.hidden = rows.every((row) => row.set.hidden);
      if (wanted && !shell.hidden && shell.tagName === "DETAILS") shell.open = true;
    }
  }

  /** Brings the controls of an element into view; returns whether it has any. */
  reveal(id) {
    const number = this.network.inputs.findIndex((input) => input.id.startsWith(`${id}.`));
    if (number < 0) return false;
    element("filter").value = "";
    this.sift();
    const shell = this.rows[number].set.parentNode;
    if (shell.tagName === "DETAILS") shell.open = true;
    this.rows[number].set.scrollIntoView({ block: "nearest" });
    return true;
  }

  show(frame, index) {
    const { figures } = frame;
    this.network.inputs.forEach((input, number) => {
      const row = this.rows[number];
      const state = frame.inputs[number] ?? "free";
      const value = frame.values[index.get(input.id)];
      if (row.faults) {
        row.faults.forEach((button, code) => {
          button.disabled = !this.network.control || state !== "free";
          button.setAttribute("aria-pressed", String(code === Math.round(value)));
        });
        const said = row.faults[Math.round(value)]?.textContent;
        if (row.said !== undefined && said !== row.said) this.say(`${input.id}: ${said}`);
        row.said = said;
        return;
      }
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
        if (BROKEN.has(state)) this.say(`${input.id} is broken: ${malfunctions(input.id)[state] ?? state}`);
        else if (BROKEN.has(was)) this.say(`${input.id} is repaired`);
      }
      const shown = write(value, unitFor(input));
      if (row.value.textContent !== shown) row.value.textContent = shown;
      // While a hand is on the slider the plant does not move it.
      if (performance.now() - row.held > 500 && document.activeElement !== row.slider && Number.isFinite(value)) {
        const { of } = unitFor(input);
        row.slider.value = row.typed ? Number(of(value).toPrecision(6)) : value;
        row.slider.setAttribute("aria-valuetext", shown);
      }
    });
    if (figures.paused !== this.paused) {
      this.paused = figures.paused;
      element("pause").textContent = this.paused ? "Run" : "Pause";
      element("pause").setAttribute("aria-pressed", String(this.paused));
      this.say(this.paused ? "the plant is held" : "the plant runs");
    }
    const speed = element("speed");
    const same = [...speed.options].find((option) => Math.abs(Number(option.value) / figures.speed - 1) < 1e-3);
    if (document.activeElement !== speed && same) speed.value = same.value;
    const chosen = String(figures.scenario);
    if (document.activeElement !== element("scenario")) element("scenario").value = chosen;
  }
}
