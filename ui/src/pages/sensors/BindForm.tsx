import { type ReactNode, useEffect, useState } from "react";
import { get, post, type Shapes } from "../../lib/api";
import { edit, say, sayError, useDesign } from "../../lib/store";
import { everyPart, findPart, isValues, treeOf } from "../../lib/tree";
import { Select, Text } from "../../parts/Field";
import { LevelSelect } from "../parts/LevelSelect";
import { OnlyFor } from "../../parts/OnlyFor";

export interface Start {
  level: string;
  topic?: string;
  field?: string;
  unit?: string;
}

const KINDS: [string, string][] = [
  ["input", "an input: temperature, load, voltage …"],
  ["position", "kilometres, from a position (x, y)"],
  ["speed", "kilometres, from a speed"],
  ["powered", "whether the robot is on"],
];
const STALE: [string, string][] = [
  ["conservative", "conservative: the last value or as designed, whichever ages faster"],
  ["nominal", "nominal: as designed"], ["hold", "hold: the last value"], ["worst", "worst: the largest rate in the range"],
];
const UNITS: Record<string, string> = { temperature: "degC", voltage: "V", humidity: "percent", load: "", current: "A", pressure: "Pa" };

export function BindForm({ start }: { start: Start }): ReactNode {
  const design = useDesign();
  const [level, setLevel] = useState(start.level);
  const [kind, setKind] = useState(/position\.[xyz]$/.test(start.field ?? "") ? "position" : "input");
  const [input, setInput] = useState("temperature");
  const [topic, setTopic] = useState(start.topic ?? "");
  const [field, setField] = useState(start.field ?? "");
  const [unit, setUnit] = useState(start.unit ?? "");
  const [low, setLow] = useState("");
  const [high, setHigh] = useState("");
  const [age, setAge] = useState("5 s");
  const [stale, setStale] = useState("conservative");
  const [tested, setTested] = useState<Shapes["SensorTested"] | null>(null);
  const inputs = useInputs();
  const part = design && findPart(design, level);
  const robotWide = kind === "powered";
  const number = (text: string): number => Number(text.replace(",", "."));
  const range = low || high ? [number(low), number(high)] : null;
  const wrongRange = range && !(range[0]! < range[1]!) ? "the lower number first" : "";

  async function test(): Promise<void> {
    try {
      setTested(await post("/api/sensors/test", { topic, field, unit, wanted: kind === "input" ? (UNITS[input] ?? unit) : unit }));
    } catch (error) {
      sayError(error);
    }
  }

  function bind(): void {
    if (!part) return;
    const at = robotWide ? [] : part.place;
    const place = kind === "input" ? ["signals", input] : kind === "powered" ? ["powered"] : ["clocks", "kilometres"];
    const value =
      kind === "input"
        ? { topic, field, ...(unit ? { unit } : {}), ...(range ? { range } : {}), ...(age !== "5 s" ? { max_age: age } : {}), ...(stale !== "conservative" ? { stale } : {}) }
        : kind === "powered"
          ? { topic, field }
          : kind === "speed"
            ? { topic, speed: field }
            : { topic, position: [field.replace(/[xyz]$/, "x"), field.replace(/[xyz]$/, "y")] };
    void edit([{ op: "put", path: [...at, ...place], value }], `Bind ${topic}.${field}`).then((done) => done && say(`Bound ${topic}.${field} to ${place.at(-1)} of ${part.name}`));
  }

  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        bind();
      }}
    >
      {!start.topic && <p className="small quiet">Choose a field of a topic, or write one.</p>}
      <Text label="Topic" placeholder="/power/temperature" value={topic} set={setTopic} />
      <Text label="Field" placeholder="temperature, or effort[2]" value={field} set={setField} />
      <Select label="Drives" value={kind} set={setKind} options={KINDS} />
      {!robotWide && <LevelSelect label="Of" value={level} set={setLevel} parts />}
      {kind === "input" && (
        <>
          <Text label="Input" list="inputs" value={input} set={setInput} hint="all parts below that take it hear it" />
          <datalist id="inputs">
            {inputs.map((one) => (
              <option key={one} value={one} />
            ))}
          </datalist>
          <div className="fields">
            <Text label="Unit of the field" placeholder="degC" value={unit} set={setUnit} />
            <Text label="Lowest that is believed" inputMode="decimal" value={low} set={setLow} />
            <Text label="Highest that is believed" inputMode="decimal" value={high} set={setHigh} wrong={wrongRange} />
            <Text label="A value holds for" value={age} set={setAge} />
          </div>
          <Select label="And then" value={stale} set={setStale} options={STALE} />
        </>
      )}
      <div className="row">
        <OnlyFor role="editor">
          <button className="primary" type="submit" disabled={!topic || !field || !part || !!wrongRange}>
            Bind
          </button>
        </OnlyFor>
        <button type="button" disabled={!topic || !field} onClick={() => void test()}>
          Test
        </button>
        {tested && <span aria-live="polite">{tested.words}</span>}
      </div>
    </form>
  );
}

/** What parts of this robot can hear: inputs of accelerations, models and variables of formulas. */
function useInputs(): string[] {
  const design = useDesign();
  const [known, setKnown] = useState<string[]>(["temperature", "load", "voltage", "humidity"]);
  useEffect(() => {
    if (!design) return;
    const models = new Set<string>();
    const found = new Set(["temperature", "load", "voltage", "humidity"]);
    for (const part of everyPart(treeOf(design))) {
      const hazard = part.values.hazard;
      if (isValues(hazard) && hazard.model) models.add(String(hazard.model));
      if (isValues(hazard) && isValues(hazard.variables)) Object.keys(hazard.variables).forEach((one) => found.add(one));
    }
    void Promise.all([...models].slice(0, 60).map((name) => get("/api/library/models/{name}", { name }).catch(() => null))).then((forms) => {
      forms.forEach((form) => form?.inputs.filter((one) => one.measurable).forEach((one) => found.add(one.name)));
      setKnown([...found]);
    });
  }, [design?.state]);
  return known;
}
