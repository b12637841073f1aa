import { type ReactNode, useEffect, useMemo, useRef, useState } from "react";
import { useHealth } from "../lib/health";
import { live, pulse, useLive } from "../lib/live";
import { useDesign, useShared, useUnit } from "../lib/store";
import { RATE_UNITS } from "../lib/words";
import { Check } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { type Curve, Plot } from "../parts/Plot";
import { Watching } from "../parts/Watching";

export const page = { name: "Live", icon: ICONS.live, order: 50 };

const WINDOWS: [string, string][] = [
  ["30", "30 s"], ["120", "2 min"], ["600", "10 min"], ["3600", "1 h"], ["28800", "8 h"], ["100000", "all"],
];
const VIEWS = [["nominal", "nominal"], ["sensor_based", "sensor-based"]] as const;

export default function Live(): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const { monitoring } = useShared(pulse);
  const { health } = useHealth();
  const [path, setPath] = useState("");
  const [seconds, setSeconds] = useState(600);
  const [log, setLog] = useState(false);
  const [paused, setPaused] = useState(false);

  const leftOut = health?.subjects.find((one) => one.path === path)?.unknown;
  const modules = (health?.subjects ?? []).map((one) => one.path);
  const signals = useMemo(() => health?.sensors.map((one) => one.signal) ?? [], [health?.sensors.map((one) => one.signal).join()]);
  const names = useMemo(
    () => [...["hazard_rate", log ? "unreliability" : "reliability", "completion"].flatMap((name) => VIEWS.map(([view]) => `${name}.${view}:${path}`)), ...signals],
    [path, log, signals],
  );
  const version = useLive(names, seconds);
  const frozen = useRef(version);
  const kept = useRef<Kept>(new Map());
  if (!paused) frozen.current = version;

  const shown = useMemo(() => {
    const newest = Math.max(...names.map((name) => live.points(name)?.times.at(-1) ?? -Infinity));
    const from = newest - seconds;
    const clip = (name: string, scale = 1): Pick<Curve, "x" | "y"> => clipped(kept.current, name, from, scale);
    const both = (name: string, scale = 1): Curve[] =>
      VIEWS.map(([view, words], i) => ({ name: words, ...clip(`${name}.${view}:${path}`, scale), dashed: i === 1, color: i }));
    return { clip, both };
    // a frozen version keeps what is shown
  }, [frozen.current, names, seconds, path]);

  const rates = useMemo(() => shown.both("hazard_rate", RATE_UNITS[unit].factor), [shown, unit]);
  const survival = useMemo(() => shown.both(log ? "unreliability" : "reliability"), [shown, log]);
  const chance = useMemo(() => shown.both("completion"), [shown]);
  const groups = useMemo(() => {
    const found = new Map<string, { unit: string; curves: Curve[]; gaps: [number, number][] }>();
    for (const one of health?.sensors ?? []) {
      const key = one.unit ?? "";
      const group = found.get(key) ?? { unit: key, curves: [], gaps: [] };
      const broken = withGaps(shown.clip(one.signal), one.max_age ?? Infinity);
      group.curves.push({ name: one.signal, x: broken.x, y: broken.y });
      group.gaps.push(...broken.gaps);
      found.set(key, group);
    }
    return [...found.values()];
  }, [shown, health?.sensors.map((one) => `${one.signal}${one.unit}${one.max_age}`).join()]);

  useEffect(() => setPath((old) => (old && health && !modules.includes(old) ? "" : old)), [health]);
  if (!design) return null;
  const empty = monitoring === "running" ? "Waiting for the first sample…" : "Nothing yet: start the analysis.";
  return (
    <>
      <div className="head">
        <h1>Live</h1>
        <span className="grow" />
        <Watching />
      </div>
      {!design.valid && <div className="trouble">The design is not complete yet; mend its problems first.</div>}
      <div className="row" style={{ marginBottom: 12 }}>
        <select aria-label="Of" value={path} onChange={(event) => setPath(event.target.value)} style={{ flex: "0 1 260px" }}>
          <option value="">the robot</option>
          {modules.filter(Boolean).map((one) => (
            <option key={one} value={one}>
              {one}
            </option>
          ))}
        </select>
        <select aria-label="Window" value={seconds} onChange={(event) => setSeconds(Number(event.target.value))} style={{ flex: "0 0 110px" }}>
          {WINDOWS.map(([value, words]) => (
            <option key={value} value={value}>
              {words}
            </option>
          ))}
        </select>
        <button onClick={() => setPaused(!paused)} aria-pressed={paused}>
          {paused ? "Go on" : "Pause"}
        </button>
        <Check label="show 1 − R, logarithmic" value={log} set={setLog} />
        <span className="quiet small">Drag across a plot to zoom. Solid: nominal; dashed: sensor-based; shaded: a sensor was silent.</span>
      </div>
      {leftOut && <p className="small">{leftOut.sentence}.</p>}
      <div className="two">
        <Plot title="Hazard rate" curves={rates} xLabel="time of the samples, UTC" yLabel={`λ [${unit}] of operation`} time empty={empty} />
        <Plot title={log ? "Probability of having failed since new" : "Reliability"} curves={survival} xLabel="time of the samples, UTC" yLabel={log ? "1 − R(t)" : "R(t), survival since new"} time log={log} empty={empty} />
        {chance.some((one) => one.x.length) && (
          <Plot title="Probability of completing the task" curves={chance} xLabel="time of the samples, UTC" yLabel="PoTC, given that it works now" time />
        )}
        {groups.map((group) => (
          <Plot key={group.unit} title={`Sensors${group.unit ? ` in ${group.unit}` : ""}`} curves={group.curves} gaps={group.gaps} xLabel="time of the samples, UTC" yLabel={group.unit ? `[${group.unit}]` : ""} time empty={empty} />
        ))}
      </div>
      {!signals.length && design.valid && (
        <p>
          No sensor is bound: sensor-based figures are the nominal ones. <a href="#/sensors">Bind a sensor.</a>
        </p>
      )}
    </>
  );
}

type Kept = Map<string, { first: number; length: number; last: number; scale: number; curve: Pick<Curve, "x" | "y"> }>;

/** The points of a series from a time on; the very same arrays as long as they are the same points. */
function clipped(kept: Kept, name: string, from: number, scale: number): Pick<Curve, "x" | "y"> {
  const points = live.points(name);
  if (!points?.times.length) return { x: [], y: [] };
  const { times, values } = points;
  let [first, beyond] = [0, times.length];
  while (first < beyond) {
    const middle = (first + beyond) >> 1;
    if (times[middle]! < from) first = middle + 1;
    else beyond = middle;
  }
  const now = { first, length: times.length, last: times[times.length - 1]!, scale };
  const old = kept.get(name);
  if (old && old.first === now.first && old.length === now.length && old.last === now.last && old.scale === scale) return old.curve;
  const y: (number | null)[] = values.slice(first);
  for (let i = 0; i < y.length; i++) y[i] = Number.isFinite(y[i]) ? y[i]! * scale : null;
  const curve = { x: times.slice(first), y };
  kept.set(name, { ...now, curve });
  return curve;
}

/** A line is not drawn across a silence; where that lasted longer than the value holds, it is shaded. */
function withGaps({ x, y }: Pick<Curve, "x" | "y">, holds: number): Pick<Curve, "x" | "y"> & { gaps: [number, number][] } {
  const silences: number[] = [];
  for (let i = 1; i < x.length; i++) if (x[i]! - x[i - 1]! > holds) silences.push(i);
  if (!silences.length) return { x, y, gaps: [] };
  const [times, values] = [[...x], [...y]];
  for (const i of [...silences].reverse()) {
    times.splice(i, 0, (x[i]! + x[i - 1]!) / 2);
    values.splice(i, 0, null);
  }
  return { x: times, y: values, gaps: silences.map((i): [number, number] => [x[i - 1]! + holds, x[i]!]) };
}
