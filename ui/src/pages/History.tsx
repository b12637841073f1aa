import { type ReactNode, useEffect, useMemo, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { pulse } from "../lib/live";
import { route, useDesign, useShared, useUnit } from "../lib/store";
import { durationText, momentText, moreText, numberText, RATE_UNITS, rateText, type RateUnit } from "../lib/words";
import { ICONS } from "../parts/Icon";
import { type Curve, Plot } from "../parts/Plot";
import { Table } from "../parts/Table";
import { broken } from "./history/broken";
import { SignalPlot } from "./history/SignalPlot";

export const page = { name: "History", icon: ICONS.stale, order: 55 };

type Past = Shapes["History"];
type Span = [from: number, to: number] | null;

const DAY = 86400;
const SPANS: [string, number][] = [["1 hour", 3600], ["1 day", DAY], ["1 week", 7 * DAY], ["1 month", 30 * DAY], ["1 year", 365 * DAY]];
const VIEWS = [["nominal", "nominal"], ["sensor_based", "sensor-based"]] as const;
const LISTED = 100;

export default function History(): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const { monitoring } = useShared(pulse);
  const named = Number.parseFloat(route.get().rest); // #/history/1790000000 begins at a moment, with the day around it
  const [span, setSpan] = useState<Span>(named ? [named - DAY / 2, named + DAY / 2] : null);
  const [past, setPast] = useState<Past | null>(null);
  const [at, setAt] = useState<number | null>(named || null);
  const [wrong, setWrong] = useState("");
  const [asked, setAsked] = useState(0);
  useEffect(() => {
    const ends = new AbortController();
    get("/api/history", { start: span?.[0], end: span?.[1], points: 800 }, ends.signal)
      .then((found) => {
        setPast(found);
        setWrong("");
      })
      .catch((error: Error) => ends.signal.aborted || setWrong(error.message));
    return () => ends.abort();
  }, [span, asked, monitoring]);
  const marks = useMemo(() => past?.events.filter((one) => !isSilence(one)).map((one) => one.time), [past]);
  const plots = useMemo(() => (past ? drawn(past, unit) : []), [past, unit]);
  if (!design) return null;
  if (!past || past.first == null || past.last == null)
    return (
      <>
        <h1>History</h1>
        {wrong ? <p className="trouble">{wrong}</p> : past ? <p>There is no past yet: a report is kept every minute while the robot is watched.</p> : <p className="quiet">Loading…</p>}
      </>
    );
  const [first, last] = [past.first, past.last];
  const [from, to] = span ?? [first, last + 1];
  const look = (long: number): void => {
    const begin = Math.min(Math.max((at ?? to) - long / 2, first), last + 1 - long);
    setSpan(long >= last - first ? null : [begin, begin + long]);
  };
  const move = (share: number): void => setSpan([from + share * (to - from), to + share * (to - from)]);
  return (
    <>
      <div className="head">
        <h1>History</h1>
        <span className="grow" />
        <span className="quiet small">
          {momentText(first)} to {momentText(last)}
        </span>
      </div>
      {wrong && <p className="trouble">{wrong}</p>}
      <Honesty asked={`${asked} ${monitoring}`} />
      <div className="row" style={{ margin: "12px 0" }}>
        <button aria-pressed={!span} onClick={() => setSpan(null)}>
          All
        </button>
        {SPANS.map(([words, long]) => (
          <button key={words} onClick={() => look(long)}>
            {words}
          </button>
        ))}
        <button disabled={from <= first} onClick={() => move(-0.5)}>
          Earlier
        </button>
        <button disabled={to >= last + 1} onClick={() => move(0.5)}>
          Later
        </button>
        <button onClick={() => setAsked(asked + 1)}>Refresh</button>
        <span className="quiet small">
          {past.times.length
            ? `${momentText(from)} to ${momentText(to)}, ${past.width ? `each point ${durationText(past.width / 3600)}` : "each point one report"}. Drag across a plot to zoom, click to see the report of then.`
            : "No report is kept of this time."}
        </span>
      </div>
      <label className="row small">
        Look at
        <input
          type="range"
          className="grow"
          min={from}
          max={to}
          step={Math.max((to - from) / 1000, 1)}
          value={at ?? to}
          aria-valuetext={momentText(at ?? to)}
          onChange={(event) => setAt(Number(event.target.value))}
        />
        <span style={{ minWidth: 190 }}>{momentText(at ?? to)}</span>
      </label>
      <div className="two" style={{ margin: "12px 0 16px" }}>
        {plots.map((one) => (
          <Plot key={one.title} {...one} xLabel="time" time marks={marks} at={at} zoomTo={(low, high) => setSpan([low, high])} pick={setAt} empty="Not known of this time." />
        ))}
        <SignalPlot signals={past.signals} span={span} asked={`${asked} ${monitoring}`} marks={marks} at={at} zoomTo={(low, high) => setSpan([low, high])} pick={setAt} />
      </div>
      <div className="stack">
        <Then at={at ?? to} unit={unit} />
        <Events past={past} look={setAt} />
      </div>
    </>
  );
}

/** How many failures were promised, and how many came. */
function Honesty({ asked }: { asked: string }): ReactNode {
  const [found, setFound] = useState<Shapes["Honesty"] | null>(null);
  useEffect(() => {
    const ends = new AbortController();
    get("/api/history/honesty", {}, ends.signal).then(setFound).catch(() => ends.signal.aborted || setFound(null));
    return () => ends.abort();
  }, [asked]);
  if (!found) return null;
  const spans = found.spans.filter((one, i, all) => i === 0 || one.since < all[0]!.since);
  return (
    <section className="card" aria-label="Was it honest?">
      <h2>Was it honest?</h2>
      {!spans.length && <p className="quiet">Not to be told: there are no two reports yet, parts of unknown rate are in it, or its figures were revised meanwhile.</p>}
      {spans.map((one) => (
        <p key={one.since}>
          Since {momentText(one.since)}: <b>{one.says}</b>
          {one.designed != null && <span className="quiet"> (as designed {numberText(one.designed, 2)})</span>}.
        </p>
      ))}
      {spans.length > 0 && (
        <p className="small quiet">
          Failures of the robot: promised by its sensor-based hazard rates as they were told then, noted as services of parts that had failed and without which it does not work
          {found.of_others > 0 && `; ${found.of_others} of others are not counted`}. What nobody noted is not in it. Tasks are on the page <a href="#/tasks">Tasks</a>, predicted beside actual.
        </p>
      )}
    </section>
  );
}

/** What is plotted: the means of both views, and how far the sensor-based one went where a point is of more than one report. */
function drawn(past: Past, unit: RateUnit): { title: string; yLabel: string; curves: Curve[] }[] {
  const hours = [
    ["hazard_rate", "Hazard rate", `λ [${RATE_UNITS[unit].axis}] of operation`, RATE_UNITS[unit].factor],
    ["unreliability", "Probability of having failed since new", "1 − R", 1],
    ["remaining_life", "Remaining life", "median [h] of calendar time", 1],
    ["task_failure", "Probability of failing the task", "1 − PoTC, given that it works then", 1],
  ] as const;
  const middle = past.times.map((time) => time + past.width / 2);
  const x = broken(past.breaks, middle, (i) => (middle[i - 1]! + middle[i]!) / 2);
  const curve = (name: string, values: (number | null)[], factor: number, more: Partial<Curve>): Curve => ({
    name,
    x,
    y: broken(past.breaks, values.map((one) => one && one * factor), () => null),
    ...more,
  });
  const found = hours.map(([figure, title, yLabel, factor]) => {
    const means = VIEWS.flatMap(([view, words], i) => {
      const values = past.figures[`${figure}.${view}`]?.mean;
      return values?.some((one) => one != null) ? [curve(words, values, factor, { dashed: i === 1, color: i })] : [];
    });
    const lived = past.width ? past.figures[`${figure}.sensor_based`] : undefined;
    const ends = lived && means.length ? [curve("sensor-based, lowest", lived.low, factor, { color: 2 }), curve("highest", lived.high, factor, { color: 3 })] : [];
    return { title, yLabel, curves: [...ends, ...means] }; // what is drawn last is on top
  });
  const of = (name: string, part: "mean" | "high"): Curve[] => {
    const values = past.figures[name]?.[part];
    return values?.some((one) => one != null) ? [curve(part === "high" ? "worst" : "since the start", values, 1, {})] : [];
  };
  const rest = [
    { title: "Hours of operation", yLabel: "[h]", curves: of("operating", "mean") },
    { title: "State", yLabel: "0 ok, 1 warning, 2 stale, 3 error", curves: of("state", "high") },
  ];
  return [...found, ...rest].filter((one) => one.curves.length);
}

/** The robot's report as it was at a time, and how far from it that is. */
function Then({ at, unit }: { at: number; unit: RateUnit }): ReactNode {
  const [found, setFound] = useState<Shapes["PastReport"] | null>(null);
  useEffect(() => {
    const ends = new AbortController();
    const later = setTimeout(() => {
      get("/api/history/report", { time: at }, ends.signal)
        .then(setFound)
        .catch(() => ends.signal.aborted || setFound(null));
    }, 150); // a slider that is drawn asks once
    return () => {
      clearTimeout(later);
      ends.abort();
    };
  }, [at]);
  if (!found) return null;
  const report = found.report as unknown as Report;
  const age = found.hours_before < 0 ? `the first that is kept, ${durationText(-found.hours_before)} later` : `${durationText(found.hours_before)} before`;
  return (
    <section className="card" aria-label="The robot as it was">
      <h2>
        As it was, {momentText(found.time)} <span className="quiet small">{age}</span>
      </h2>
      <p>
        State: <b>{report.state}</b>
        {[...(report.breaches ?? []), ...(report.warnings ?? [])].map((words) => (
          <span key={words}>; {words}</span>
        ))}
      </p>
      <Table label="Figures of then" columns={["", ["λ nominal", "number"], ["λ sensor-based", "number"], ["1 − R nominal", "number"], ["1 − R sensor-based", "number"], "Flags"]}>
        {report.subjects?.map((one) => (
          <tr key={`${one.kind} ${one.path}`}>
            <th scope="row">{one.path}</th>
            <td className="number">{rateText(one.nominal.hazard_rate, unit)}</td>
            <td className="number">{rateText(one.sensor_based.hazard_rate, unit)}</td>
            <td className="number">{numberText(one.nominal.unreliability)}</td>
            <td className="number">{numberText(one.sensor_based.unreliability)}</td>
            <td>{one.flags.join(", ") || "–"}</td>
          </tr>
        ))}
      </Table>
    </section>
  );
}

/** As far as it is shown here, a report as it is kept. */
interface Report {
  state: string;
  breaches?: string[];
  warnings?: string[];
  subjects?: { kind: string; path: string; flags: string[]; nominal: Figures; sensor_based: Figures }[];
}
interface Figures {
  hazard_rate: number;
  unreliability: number;
}

type Happened = Past["events"][number];
const isSilence = (one: Happened): boolean => one.kind.startsWith("silence");

/** What happened; silences, of which every night has one of each signal, where they are asked for. */
function Events({ past, look }: { past: Past; look: (time: number) => void }): ReactNode {
  const [all, setAll] = useState(false);
  const silences = past.events.filter(isSilence).length;
  const told = all ? past.events : past.events.filter((one) => !isSilence(one));
  const listed = told.slice(-LISTED).reverse();
  return (
    <section className="card" aria-label="Events">
      <div className="row">
        <h2>Events</h2>
        <span className="grow" />
        {silences > 0 && (
          <label className="check">
            <input type="checkbox" checked={all} onChange={(event) => setAll(event.target.checked)} /> list silences too ({silences})
          </label>
        )}
      </div>
      {listed.length ? (
        <Table label="Events, the latest first" className="scroll stacked" columns={["Time", "What", ["Said of it", "spoken"]]}>
          {listed.map((one) => (
            <tr key={`${one.time} ${one.kind} ${one.subject}`}>
              <td>
                {one.time < 1 ? (
                  "before its first recording"
                ) : (
                  <button onClick={() => look(one.time)}>{momentText(one.time)}</button>
                )}
              </td>
              <td>{one.kind}</td>
              <td>{one.said}</td>
            </tr>
          ))}
        </Table>
      ) : (
        <p className="quiet">{silences ? "Nothing but silences is known of this time." : "None is known of this time."}</p>
      )}
      {told.length > LISTED && <p className="small quiet">{moreText(told.length - LISTED)}</p>}
    </section>
  );
}
