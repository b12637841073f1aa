import type { ReactNode } from "react";
import { isValues, type Part } from "../../lib/tree";
import { Entry, Select } from "../../parts/Field";
import type { Putting } from "./Inspector";

const DISTRIBUTIONS: [string, string][] = [
  ["exponential", "exponential: constant rate"], ["weibull", "Weibull"], ["rayleigh", "Rayleigh"], ["curve", "curve (Smith–Bain)"],
  ["lognormal", "lognormal"], ["normal", "normal"], ["gamma", "gamma"], ["loglogistic", "loglogistic"], ["extreme_value", "extreme value"],
];
/** What is asked for beside the rate, from which the scale follows; a usual value where there must be one. */
const SHAPES: Record<string, [string, string, number | null][]> = {
  weibull: [["shape", "Shape β", 2], ["location", "Location γ", null]],
  rayleigh: [["location", "Location γ", null]],
  curve: [["shape", "Shape c", 1]],
  lognormal: [["log_deviation", "Deviation σ of ln t", 0.5]],
  normal: [["deviation", "Deviation", 1000]],
  gamma: [["shape", "Shape", 2]],
  loglogistic: [["shape", "Shape β", 2]],
  extreme_value: [["scale", "Scale", 1000]],
};
const ACCELERATIONS: [string, string][] = [
  ["", "as the level above says"], ["none", "none"], ["q10", "Q10: twice the rate every 10 K"], ["arrhenius", "Arrhenius (temperature)"],
  ["eyring", "Eyring"], ["peck", "Peck (humidity)"], ["coffin_manson", "Coffin–Manson (cycles)"], ["cubic_load", "cubic load"], ["inverse_power", "inverse power (voltage)"],
];
const PARAMETERS: Record<string, [string, string, string][]> = {
  q10: [["reference_temperature", "Reference temperature", "25 degC"], ["q", "Factor for 10 K", "2"]],
  arrhenius: [["activation_energy", "Activation energy", "0.7 eV"], ["reference_temperature", "Reference temperature", "25 degC"]],
  eyring: [["activation_energy", "Activation energy", "0.7 eV"], ["reference_temperature", "Reference temperature", "25 degC"]],
  peck: [["activation_energy", "Activation energy", "0.8 eV"], ["reference_temperature", "Reference temperature", "25 degC"], ["reference_humidity", "Reference humidity", "50 percent"], ["exponent", "Exponent", "2.7"]],
  coffin_manson: [["reference_temperature_swing", "Reference swing", "40 K"], ["exponent", "Exponent", "2"]],
  cubic_load: [["reference_load", "Reference load", "1"]],
  inverse_power: [["reference_voltage", "Reference voltage", "12 V"], ["exponent", "Exponent", "3"]],
};
const CLOCKS: [string, string][] = [
  ["operating", "operating hours"], ["calendar", "calendar hours"], ["kilometres", "kilometres"], ["cycles", "cycles"], ["starts", "starts"],
];

/** Life model, its shape, the acceleration (ALT) model and the clock. */
export function Life({ part, put }: { part: Part; put: Putting }): ReactNode {
  const life = isValues(part.values.life) ? part.values.life : {};
  const usual = part.values.part === undefined ? "exponential" : ""; // of a part of the library, as it says
  const distribution = String(life.distribution ?? (part.values.life === undefined ? usual : "exponential"));
  const asText: [string, string][] = ["", ...DISTRIBUTIONS.map(([name]) => name)].includes(distribution) ? [] : [[distribution, `${distribution}: as text below`]];
  const lives = [...asText, ...DISTRIBUTIONS];
  const usualClock = part.values.part === undefined ? "operating" : "";
  const stress = part.values.acceleration;
  const several = Array.isArray(stress);
  const said = isValues(stress) ? stress : {};
  const model = several ? "several" : typeof stress === "string" ? stress : String(said.model ?? "");
  const number = (value: string): unknown => (value.trim() !== "" && Number.isFinite(Number(value)) ? Number(value) : value || undefined);
  const component = part.kind === "component";
  const start = (name: string): void => {
    const parameters = Object.fromEntries((PARAMETERS[name] ?? []).map(([key, , usual]) => [key, number(usual)]));
    put(["acceleration"], name === "" ? undefined : name === "none" ? "none" : { model: name, ...parameters }, `Acceleration of ${part.name}`);
  };
  return (
    <>
      {component && (
        <>
          <h3>Life</h3>
          <Select label="Life model" value={distribution} options={usual ? lives : [["", "as its part of the library"], ...lives]} set={(value) => put(["life"], value === usual ? undefined : { distribution: value, ...usualShape(value) }, `Life model of ${part.name}`)} />
          <div className="fields">
            {(SHAPES[distribution] ?? []).map(([key, name]) => (
              <Entry key={key} label={name} value={String(life[key] ?? "")} set={(value) => put(["life", key], number(value), `${name} of ${part.name}`)} />
            ))}
          </div>
          <div className="fields">
            <Select label="Ages on" value={String(part.values.clock ?? usualClock)} options={usualClock ? CLOCKS : [["", "as its part of the library"], ...CLOCKS]} set={(value) => put(["clock"], value === usualClock ? undefined : value, `Clock of ${part.name}`)} />
            <Entry label="Already used" hint="e.g. 1200 h" value={String(part.values.initial_exposure ?? "")} set={(value) => put(["initial_exposure"], value, `Exposure of ${part.name}`)} />
          </div>
        </>
      )}
      <h3>Acceleration by stress (ALT)</h3>
      <Select
        label={component ? "Acceleration model" : "Acceleration model of the constant-rate parts below"}
        value={model}
        options={several ? [["several", "several: as text below"], ...ACCELERATIONS] : ACCELERATIONS}
        set={start}
      />
      <div className="fields">
        {(PARAMETERS[model] ?? []).map(([key, name]) => (
          <Entry key={key} label={name} value={String(said[key] ?? "")} set={(value) => put(["acceleration", key], number(value), `${name} of ${part.name}`)} />
        ))}
      </div>
    </>
  );
}

function usualShape(distribution: string): Record<string, number> {
  const asked = (SHAPES[distribution] ?? []).filter((one) => one[2] != null);
  return Object.fromEntries(asked.map(([key, , usual]) => [key, usual ?? 0]));
}
