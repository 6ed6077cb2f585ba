// Records what is shown, as comma-separated values with SI units.

const MOST = 20_000_000; // values

export class Recorder {
  constructor(network, button, counter) {
    this.names = network.values.map((value) => value.id);
    this.rows = null;
    button.onclick = () => {
      if (this.rows) this.save(); else this.rows = [];
      button.setAttribute("aria-pressed", String(Boolean(this.rows)));
      button.textContent = this.rows ? "Stop and save" : "Record";
      counter.textContent = "";
    };
    this.button = button;
    this.counter = counter;
  }

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
    Object.assign(link, { href: file, download: "eclss-rt.csv" });
    link.click();
    setTimeout(() => URL.revokeObjectURL(file), 10_000);
    this.rows = null;
  }
}
