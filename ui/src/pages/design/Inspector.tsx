import { type ReactNode, useEffect, useState } from "react";
import { type DesignState, get, type Operation, type Shapes } from "../../lib/api";
import { useHealth } from "../../lib/health";
import { edit, go, useUnit } from "../../lib/store";
import { change, isValues, type Part } from "../../lib/tree";
import { durationText, marked, rateText } from "../../lib/words";
import { Check, Entry, Select } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { ProblemsHere } from "../../parts/Problems";
import { WearPlot } from "../../parts/WearPlot";
import { Life } from "./Life";
import { RateOf } from "./RateOf";

/** All that can be said of one part, a module or the robot. */
export function Inspector({ part, several, design, editText }: { part: Part; several: number; design: DesignState; editText: () => void }): ReactNode {
  const unit = useUnit();
  const { health } = useHealth();
  const figures = design.levels[part.path];
  const problems = design.problems.filter((one) => part.place.every((key, i) => one.place[i] === key) && one.place.length >= part.place.length);
  const mine = part.kind === "component" ? problems : problems.filter((one) => !["modules", "components"].includes(one.place[part.place.length] ?? ""));
  const put = (key: string[], value: unknown, what: string): void => {
    const operations = change(part, key, value);
    if (operations.length) void edit(operations, what);
  };
  const text = (key: string): string => String(part.values[key] ?? "");
  return (
    <>
      <h2>{part.name}</h2>
      <p className="small quiet">
        {several > 1 ? `${several} parts are chosen; this is the first. ` : ""}
        {part.kind}
        {part.path && ` · ${part.path}`}
      </p>
      {figures && (
        <p>
          <strong>{marked(design.unknown[part.path], "hazard_rate", rateText(figures.hazard_rate, unit))}</strong>{" "}
          <span className="quiet small">
            when new{figures.quantity > 1 ? `, all ${figures.quantity} together` : ""}
          </span>
          <HowLong path={part.path} state={design.state} />
          {figures.single_point && (
            <span className="badge warning" style={{ marginLeft: 6 }}>
              single point of failure
            </span>
          )}
        </p>
      )}
      {mine.length > 0 && <ProblemsHere problems={mine} />}
      {health?.wear.filter((one) => one.part === part.path).map((one) => <WearPlot key={one.mode} one={one} />)}
      <OnlyFor role="editor">
        <Entry label="Description" value={text("description")} set={(value) => put(["description"], value, `Describe ${part.name}`)} />
        {part.kind === "component" ? <OfComponent part={part} put={put} /> : <OfLevel part={part} put={put} />}
      </OnlyFor>
      <h3 style={{ marginTop: 12 }}>Sensors bound here</h3>
      <Bound part={part} />
      <p>
        <button onClick={editText}>Edit as text…</button>
      </p>
    </>
  );
}

/** Mean and median life when new, through redundancy and ageing: a hazard rate alone does not say them. */
function HowLong({ path, state }: { path: string; state: number }): ReactNode {
  const [found, setFound] = useState<Shapes["LifeOf"] | null>(null);
  useEffect(() => {
    const asked = new AbortController();
    get("/api/analysis/life", { path }, asked.signal)
      .then(setFound)
      .catch(() => !asked.signal.aborted && setFound(null));
    return () => asked.abort();
  }, [path, state]);
  if (!found || found.path !== path) return null;
  const text = (hours: number | null): string => marked(found.unknown, "ahead", durationText(hours));
  return (
    <span className="small" style={{ display: "block" }}>
      mean life {text(found.life.mean)}, median {text(found.life.median)}
      <span className="quiet"> of calendar time when new</span>
      {found.unknown && <span className="quiet">. {found.unknown.sentence}</span>}
    </span>
  );
}

export type Putting = (key: string[], value: unknown, what: string) => void;

function OfComponent({ part, put }: { part: Part; put: Putting }): ReactNode {
  const values = part.values;
  const whole = (value: string): number | string | undefined => (value.trim() === "" ? undefined : /^\d+$/.test(value.trim()) ? Number(value) : value);
  return (
    <>
      <div className="fields">
        <Entry label="Quantity" inputMode="numeric" value={String(values.quantity ?? 1)} set={(value) => put(["quantity"], whole(value), `Quantity of ${part.name}`)} />
        <Entry label="Of which must work" hint="empty: all" inputMode="numeric" value={String(values.required ?? "")} set={(value) => put(["required"], whole(value), `Required of ${part.name}`)} />
      </div>
      <RateOf part={part} />
      <Life part={part} put={put} />
      <Check label="known to work until reported failed (monitored)" value={values.monitored === true} set={(value) => put(["monitored"], value || undefined, `Monitor ${part.name}`)} />
    </>
  );
}

function OfLevel({ part, put }: { part: Part; put: Putting }): ReactNode {
  const values = part.values;
  const nested = (key: string, inner: string): string => {
    const found = values[key];
    return isValues(found) ? String(found[inner] ?? "") : "";
  };
  const operations = (ops: Operation[], what: string): void => void (ops.length && edit(ops, what));
  return (
    <>
      {part.kind === "robot" && (
        <Entry label="Name of the robot" value={part.name} set={(value) => value && operations([{ op: "put", path: ["name"], value }], `Name the robot ${value}`)} />
      )}
      <Entry label="Environment" hint="e.g. vehicle, indoor, flying, or a symbol such as GM; inherited by all parts below" value={String(values.environment ?? "")} set={(value) => put(["environment"], value, `Environment of ${part.name}`)} />
      <Life part={part} put={put} />
      {part.kind === "robot" && (
        <>
          <h3>Usage</h3>
          <div className="fields">
            <Entry label="Share of the day that it works" hint="e.g. 0.3, 30 % or 8 h/day" value={nested("usage", "operating")} set={(value) => put(["usage", "operating"], value && (isNaN(Number(value)) ? value : Number(value)), "Usage")} />
            <Entry label="Driven per hour of operation" hint="e.g. 0.7 km/h" value={nested("usage", "kilometres")} set={(value) => put(["usage", "kilometres"], value, "Usage")} />
          </div>
          <h3>Its usual task</h3>
          <div className="fields">
            <Entry label="Distance" hint="e.g. 250 m" value={nested("task", "distance")} set={(value) => put(["task", "distance"], value, "Task")} />
            <Entry label="Speed" hint="e.g. 0.3 m/s" value={nested("task", "speed")} set={(value) => put(["task", "speed"], value, "Task")} />
            <Entry label="or duration" hint="e.g. 20 min" value={nested("task", "duration")} set={(value) => put(["task", "duration"], value, "Task")} />
          </div>
        </>
      )}
      <Select
        label="How what is in it is wired"
        value={values.diagram === undefined ? "series" : "drawn"}
        options={[["series", "all in series"], ["drawn", "as drawn"]]}
        disabled={values.diagram === undefined}
        set={(value) => value === "series" && void edit([{ op: "wire", path: part.place, diagram: null }], `${part.name} in series`)}
        hint="choose parts and press Group… to draw groups"
      />
    </>
  );
}

function Bound({ part }: { part: Part }): ReactNode {
  const bound = isValues(part.values.signals) ? Object.entries(part.values.signals) : [];
  return (
    <>
      {bound.map(([input, binding]) => (
        <p key={input} className="small">
          <strong>{input}</strong>: {isValues(binding) ? `${String(binding.topic)}.${String(binding.field)}` : "?"}
        </p>
      ))}
      <button onClick={() => go("sensors", part.path)}>{bound.length ? "Change…" : "Bind a sensor…"}</button>
    </>
  );
}
