import { type ReactNode, useEffect, useMemo, useRef, useState } from "react";
import { useHealth } from "../lib/health";
import { useLimits } from "../lib/alarms";
import { live, pulse, useLive } from "../lib/live";
import { useDesign, useShared, useUnit } from "../lib/store";
import { RATE_UNITS, unitText } from "../lib/words";
import { Check } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { type Curve, type Limit, Plot } from "../parts/Plot";
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
      group.curves.push({ name: one.signal, ...shown.clip(one.signal) });
      group.gaps.push(...live.gaps(one.signal));
      found.set(key, group);
    }
    return [...found.values()];
  }, [shown, health?.sensors.map((one) => `${one.signal}${one.unit}`).join()]);

  const stated = useLimits();
  const limit = (series: string[], change: (value: number) => number = (value) => value): Limit[] =>
    stated.filter((one) => series.includes(one.series)).map((one) => ({ value: change(one.limit), severity: one.severity }));
  const own = (figure: string): string[] => [`${figure}.sensor_based:${path}`];

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
        <Plot key={`rate ${seconds}`} title="Hazard rate" limits={limit(own("hazard_rate"), (value) => value * RATE_UNITS[unit].factor)} curves={rates} xLabel="time of the samples" yLabel={`λ [${RATE_UNITS[unit].axis}] of operation`} time empty={empty} />
        <Plot key={`survival ${seconds}`} title={log ? "Probability of having failed since new" : "Reliability"} limits={limit(own("reliability"), (value) => (log ? 1 - value : value))} curves={survival} xLabel="time of the samples" yLabel={log ? "1 − R(t)" : "R(t), survival since new"} time log={log} empty={empty} />
        {chance.some((one) => one.x.length) && (
          <Plot key={`task ${seconds}`} title="Probability of completing the task" limits={limit(own("completion"))} curves={chance} xLabel="time of the samples" yLabel="PoTC, given that it works now" time />
        )}
        {groups.map((group) => (
          <Plot key={`${group.unit} ${seconds}`} title={`Sensors${group.unit ? ` in ${unitText(group.unit)}` : ""}`} limits={limit(group.curves.map((one) => one.name))} curves={group.curves} gaps={group.gaps} xLabel="time of the samples" yLabel={group.unit ? `[${unitText(group.unit)}]` : ""} time empty={empty} />
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

type Kept = Map<string, { of: string; curve: Pick<Curve, "x" | "y"> }>;

/** The points of a series from a time on, broken where there was no value; the very same arrays as long as they are the same points. */
function clipped(kept: Kept, name: string, from: number, scale: number): Pick<Curve, "x" | "y"> {
  const points = live.points(name);
  if (!points?.times.length) return { x: [], y: [] };
  const { times, values } = points;
  const [first, gaps] = [atLeast(times, from), live.gaps(name)];
  const of = [first, times.length, times.at(-1), scale, gaps.length, gaps.at(-1)].join();
  const old = kept.get(name);
  if (old?.of === of) return old.curve;
  const x = times.slice(first);
  const y: (number | null)[] = values.slice(first).map((value) => (Number.isFinite(value) ? value * scale : null));
  for (const [since, until] of gaps) {
    const after = atLeast(x, until);
    if (!x.length || x[after - 1]! > since || until <= x[0]!) continue;
    x.splice(after, 0, after < x.length ? (since + until) / 2 : until);
    y.splice(after, 0, null);
  }
  const curve = { x, y };
  kept.set(name, { of, curve });
  return curve;
}

/** The place of the first of rising numbers that is not below a bound. */
function atLeast(rising: number[], bound: number): number {
  let [first, beyond] = [0, rising.length];
  while (first < beyond) {
    const middle = (first + beyond) >> 1;
    if (rising[middle]! < bound) first = middle + 1;
    else beyond = middle;
  }
  return first;
}
