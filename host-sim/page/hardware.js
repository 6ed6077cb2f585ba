// The loop and its hardware: mode, overruns, link, and what each channel is worth. Hidden where there is none.

import { writeAll } from "./figures.js";
import { show } from "./units.js";

const element = (id) => document.getElementById(id);

const row = (cells, kind) => {
  const made = document.createElement("tr");
  made.replaceChildren(...cells.map((text, place) => {
    const cell = document.createElement(kind ?? (place === 0 ? "th" : "td"));
    if (cell.tagName === "TH") cell.scope = kind ? "col" : "row";
    cell.textContent = text;
    return cell;
  }));
  return made;
};

export class Hardware {
  constructor(network) {
    this.channels = network.channels;
    this.rows = this.channels.map(({ id, input }) => row([id, input ? "in" : "out", "", ""]));
    element("channels").replaceChildren(...this.rows);
    element("channels-table").hidden = this.rows.length === 0;
  }

  show({ hardware }) {
    element("hardware").hidden = !hardware;
    if (!hardware) return;
    const { link } = hardware;
    const lines = [
      ["Mode", hardware.cause ? `${hardware.mode}: ${hardware.cause}` : hardware.mode, hardware.mode === "SAFE"],
      ["Rate", `${show(hardware.rate_hz, 1)} Hz`],
      // A board that is only watched tells of its channels, not of its timing.
      ...(hardware.overruns === null ? [] : [
        ["Overruns", `${hardware.overruns}, ${hardware.overruns_in_a_row} in a row`, hardware.overruns > 0],
        ["Missed ticks", String(hardware.missed), hardware.missed > 0],
        ["Latest wake-up", `${hardware.late_us} µs`],
      ]),
      ["Link", link ? (link.connected ? "up" : "down") : "none", Boolean(link) && !link.connected],
      ...(link ? [
        ["Frames taken", `${link.accepted} in ${link.sessions} sessions`],
        ["lost, late, damaged, foreign", `${link.lost}, ${link.late}, ${link.damaged}, ${link.foreign}`,
          link.lost + link.late + link.damaged + link.foreign > 0],
        ["Silent for", `${link.silence} ticks`],
        ["Round trip", link.round_trip_us === null ? "–" : `${link.round_trip_us} µs`],
      ] : []),
    ];
    writeAll(element("loop"), lines);
    this.rows.forEach((cells, place) => {
      const [, , quality, rejected] = cells.children;
      quality.textContent = hardware.quality[place] ?? "";
      rejected.textContent = String(hardware.rejected[place] ?? "–");
    });
  }
}
