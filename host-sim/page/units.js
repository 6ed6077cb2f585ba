// Quantities as people read them. The plant sends SI; nothing but this file knows other units.

const GAS_CONSTANT = 287.05; // J/(kg·K), dry air
const CFM = 4.719474432e-4; // m³/s in a cubic foot a minute
const MMHG = 133.322387415; // Pa in a millimetre of mercury

let system = "si";
export const useUnits = (name) => { system = name === "us" ? "us" : "si"; };

/** A number with `digits` behind the point and a real minus sign. */
export function show(number, digits) {
  if (!Number.isFinite(number)) return "–";
  const text = number.toFixed(digits);
  // What rounds to nothing has no sign.
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

const digitsFor = (number, most) => {
  const size = Math.abs(number);
  return size >= 100 ? Math.min(most, 1) : size >= 10 ? Math.min(most, 2) : most;
};

/** Absolute pressure [Pa]. */
export const pressure = () => system === "us"
  ? { unit: "mmHg", of: (pa) => pa / MMHG, digits: 2, fixed: true }
  : { unit: "kPa", of: (pa) => pa * 1e-3, digits: 3, fixed: true };
/** Pressure over the reference [Pa]. */
export const gauge = () => system === "us"
  ? { unit: "mmHg", of: (pa) => pa / MMHG, digits: 3 }
  : { unit: "Pa", of: (pa) => pa, digits: 2, large: { unit: "kPa", of: (pa) => pa * 1e-3, digits: 2 } };
/** Mass flow [kg/s]; as volume flow at `density` [kg/m³], as mass flow of a liquid, whose density is null. */
export const flow = (density) => system === "us"
  ? density === null
    ? { unit: "lb/h", of: (kg) => kg * 7936.641, digits: 3 }
    : { unit: "cfm", of: (kg) => kg / (density > 0 ? density : 1.2) / CFM, digits: 3 }
  : { unit: "g/s", of: (kg) => kg * 1e3, digits: 3 };
export const temperature = () => system === "us"
  ? { unit: "°F", of: (k) => (k - 273.15) * 1.8 + 32, digits: 1 }
  : { unit: "°C", of: (k) => k - 273.15, digits: 1 };
/** Difference of temperatures [K]. */
const warmth = () => system === "us"
  ? { unit: "°F", of: (k) => k * 1.8, digits: 2 }
  : { unit: "K", of: (k) => k, digits: 2 };
/** Partial pressure [Pa]. */
export const partial = () => system === "us"
  ? { unit: "mmHg", of: (pa) => pa / MMHG, digits: 2 }
  : { unit: "kPa", of: (pa) => pa * 1e-3, digits: 3, fixed: true };
/** A trickle, such as condensate or make-up gas [kg/s]. */
export const trickle = () => system === "us"
  ? { unit: "lb/h", of: (kg) => kg * 7936.641, digits: 3 }
  : { unit: "g/h", of: (kg) => kg * 3.6e6, digits: 1 };
const mass = () => system === "us"
  ? { unit: "lb", of: (kg) => kg * 2.2046226, digits: 3 }
  : { unit: "kg", of: (kg) => kg, digits: 3 };
const stream = () => system === "us"
  ? { unit: "cfm", of: (volume) => volume / CFM, digits: 2 }
  : { unit: "l/s", of: (volume) => volume * 1e3, digits: 2 };
export const ratio = () => ({ unit: "%", of: (part) => part * 100, digits: 1 });
const plain = (unit) => ({ unit: unit === "1" ? "" : unit, of: (number) => number, digits: 4 });

export const density = (pa, kelvin) => pa / (GAS_CONSTANT * kelvin);

/** What is published for a quantity that was typed in the unit shown. */
export const back = (shown, unit) => (shown - unit.of(0)) / (unit.of(1) - unit.of(0));

/** Units by the form that the plant publishes with a value or an input; `at` is the density of what flows [kg/m³]. */
const FORMS = {
  gauge_pressure: () => ({ ...gauge(), datum: "gauge" }),
  absolute_pressure: () => ({ ...pressure(), datum: "abs" }),
  partial_pressure: partial,
  pressure_difference: gauge,
  mass_flow: flow,
  liquid_flow: () => flow(null),
  trickle,
  volume_flow: stream,
  temperature,
  temperature_difference: warmth,
  mass,
  time: () => ({ ...plain("s"), digits: 1 }),
  ratio,
  count: () => ({ ...plain("1"), digits: 1 }),
};

/** The unit for a published value or an input. */
export const unitFor = ({ display, unit }, at) => (FORMS[display] ?? (() => plain(unit)))(at);

/** Plant time [s]; from ten minutes on as hours, minutes and seconds. */
export function clock(seconds) {
  if (!(seconds >= 600)) return `${show(seconds, 2)} s`;
  const two = (number) => String(Math.floor(number)).padStart(2, "0");
  return `${Math.floor(seconds / 3600)}:${two((seconds / 60) % 60)}:${two(seconds % 60)}`;
}

/** A value with its unit. */
export function write(number, unit) {
  if (number === null || number === undefined || !Number.isFinite(number)) return "–";
  if (unit.large && Math.abs(unit.of(number)) >= 1e4) return write(number, { ...unit.large, datum: unit.datum });
  const value = unit.of(number);
  return `${show(value, unit.fixed ? unit.digits : digitsFor(value, unit.digits))}${unit.unit ? ` ${unit.unit}` : ""}${unit.datum ? ` ${unit.datum}` : ""}`;
}
