import { type ReactNode, useEffect, useState } from "react";
import type { Health, Shapes } from "../lib/api";
import { horizon, useHealth } from "../lib/health";
import { useDesign, useShared, useUnit } from "../lib/store";
import { isEmpty } from "../lib/tree";
import { durationText, marked, momentText, moreText, numberText, percentText, rateText, secondsText, shareText, type Unknown, unitText } from "../lib/words";
import { Bars } from "../parts/Bars";
import { Select } from "../parts/Field";
import { ICONS, State } from "../parts/Icon";
import { ProblemList } from "../parts/Problems";
import { Watching } from "../parts/Watching";
import { WearPlot } from "../parts/WearPlot";
import { Cards } from "./overview/Cards";
import { Ranges } from "./overview/Ranges";

export const page = { name: "Overview", icon: ICONS.pulse, order: 10 };

export default function Overview(): ReactNode {
  const design = useDesign();
  const { health, error } = useHealth();
  const empty = design !== null && isEmpty(design);
  useEffect(() => {
    if (empty) location.replace("#/new");
  }, [empty]);
  if (!design || empty) return null;
  return (
    <>
        <div className="head">
          <h1>{design.name}</h1>
          {health && <State of={health.state} limited={health.limits_set} />}
          {health && !health.limits_set && <span className="quiet small">no thresholds are set: nothing is called too low (<a href="#/settings">set some</a>)</span>}
          {health && health.alarms > 0 && (
            <a href="#/alarms">
              {health.alarms} {health.alarms === 1 ? "alarm" : "alarms"}
              {health.unacknowledged > 0 && `, ${health.unacknowledged} not acknowledged`}
            </a>
          )}
          <span className="quiet small">{health?.time != null && `up to ${momentText(health.time)}`}</span>
          <span className="grow" />
          <Watching />
        </div>
        {!design.valid && (
          <div className="trouble" role="alert">
            <h2>The design is not complete yet</h2>
            <ProblemList problems={design.problems.filter((one) => one.level === "error")} />
          </div>
        )}
        {error && design.valid && <div className="trouble" role="alert">{error}</div>}
        {health && <Figures health={health} />}
    </>
  );
}

function Figures({ health }: { health: Health }): ReactNode {
  const robot = health.subjects[0];
  if (!robot) return null;
  const left = robot.unknown;
  return (
    <>
      {health.sentence && (
        <details className="answer">
          <summary>{health.sentence.replaceAll(" %", "\u00a0%")}</summary>
          {health.reasons.map((line, i) => (
            <p key={i} className={line.detail ? "small behind" : ""}>{line.text}</p>
          ))}
        </details>
      )}
      {health.why.length > 0 && (
        <div className="trouble">
          {health.why.map((one) => (
            <p key={one}>{one}</p>
          ))}
        </div>
      )}
      {left && <p className="small">{left.sentence}.</p>}
      {health.design_changed && <p className="quiet">The design has been changed since watching began: stop and start to use it. Its past goes on.</p>}
      <Cards health={health} />
      <Ranges />
      <div className="two">
        <section className="card">
          <ToCome found={health.to_come} left={left} />
        </section>
        <section className="card">
          <h2>Sensors</h2>
          <Sensors sensors={health.sensors} idle={health.monitoring === "idle"} />
        </section>
      </div>
      {health.wear.length > 0 && (
        <section className="card" style={{ marginTop: 16 }}>
          <h2>Seen to wear</h2>
          <Wear parts={health.wear} />
        </section>
      )}
      <section className="card" style={{ marginTop: 16 }}>
        <h2>Modules</h2>
        {health.subjects.length > 1 ? (
          <div className="scroll stacked" tabIndex={0} role="region" aria-label="Modules">
            <Modules subjects={health.subjects} />
          </div>
        ) : (
          <p className="quiet">The design has parts alone, no modules.</p>
        )}
      </section>
      {health.notes.length > 0 && (
        <section className="card" style={{ marginTop: 16 }}>
          <h2>Notes</h2>
          {health.notes.map((note) => (
            <p key={note}>{note}</p>
          ))}
        </section>
      )}
    </>
  );
}

const HORIZONS: [string, string][] = [
  ["", "the median remaining life"], ["24", "1 day"], ["168", "1 week"], ["730.5", "1 month"], ["8766", "1 year"], ["87660", "10 years"],
];

/** Which parts the failures to come will come from, within a horizon that the user chooses. */
function ToCome({ found, left }: { found: Health["to_come"]; left: Unknown }): ReactNode {
  const ahead = useShared(horizon);
  return (
    <>
      <div className="row">
        <h2>What will fail it</h2>
        <span className="grow" />
        <Select label="within" value={ahead == null ? "" : String(ahead)} options={HORIZONS} set={(value) => horizon.set(value ? Number(value) : null)} />
      </div>
      {!found && <p className="quiet">…</p>}
      {found && !found.parts.length && <p>As far as is known nothing is left to fail.</p>}
      {found && found.parts.length > 0 && (
        <>
          <p className="small quiet">
            Share of the failures within {durationText(found.horizon)}
            {!found.stated && ", the median remaining life,"} that a part brings about; it fails within that time with {marked(left, "failing", percentText(found.sensor_based_failure))}.
          </p>
          <Bars
            title={`Share of the failures within ${durationText(found.horizon)}`}
            names={["nominal", "sensor-based"]}
            bars={found.parts.map((one) => ({
              name: `${one.path}${one.quantity > 1 ? ` ×${one.quantity}` : ""}`,
              values: [one.nominal, one.sensor_based],
              words: shareText(one.sensor_based),
              href: one.group ? undefined : `#/design/${encodeURI(one.path)}`,
            }))}
          />
          <p className="small quiet">{[...found.notes, ...(found.more ? [`${moreText(found.more)}.`] : [])].join(" ")}</p>
        </>
      )}
    </>
  );
}

function Sensors({ sensors, idle }: { sensors: Shapes["Freshness"][]; idle: boolean }): ReactNode {
  if (!sensors.length)
    return (
      <p>
        No sensor is bound yet. <a href="#/sensors">Bind one</a>, and sensor-based figures stand beside the nominal ones.
      </p>
    );
  return (
    <table>
      <thead>
        <tr>
          <th scope="col">Signal</th>
          <th scope="col" className="number">Last value</th>
          <th scope="col">Heard</th>
        </tr>
      </thead>
      <tbody>
        {sensors.map((one) => (
          <tr key={one.signal}>
            <th scope="row">{one.signal}</th>
            <td className="number">{one.value == null ? "–" : `${numberText(one.value)} ${unitText(one.unit)}`}</td>
            <td>{idle ? "not watching" : <span className={one.stale ? "state stale" : ""}>{one.stale ? `STALE, ${secondsText(one.age)}` : secondsText(one.age)}</span>}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** Which parts sensors see wear, and when they reach their thresholds: sensor-based figures have it in the place of their hazard. */
function Wear({ parts }: { parts: Shapes["WornPart"][] }): ReactNode {
  const [mode, setMode] = useState("");
  const shown = parts.find((one) => one.mode === mode) ?? parts[0]!;
  return (
    <>
    <div className="scroll stacked" tabIndex={0} role="region" aria-label="Seen to wear">
      <table>
        <thead>
          <tr>
            <th scope="col">Failure mode</th>
            <th scope="col">Signal</th>
            <th scope="col" className="number">Last reading</th>
            <th scope="col" className="number">Threshold</th>
            <th scope="col">What it says</th>
          </tr>
        </thead>
        <tbody>
          {parts.map((one) => (
            <tr key={one.mode}>
              <th scope="row">
                <a href={`#/design/${encodeURI(one.part)}`}>{one.mode}</a>
              </th>
              <td data-label="Signal">
                {parts.length > 1 ? (
                  <button className={one === shown ? "primary" : undefined} aria-pressed={one === shown} onClick={() => setMode(one.mode)}>
                    {one.signal}
                  </button>
                ) : (
                  one.signal
                )}
              </td>
              <td className="number" data-label="Last reading">{one.last == null ? "–" : numberText(one.last)}</td>
              <td className="number" data-label="Threshold">{numberText(one.threshold)}</td>
              <td data-label="What it says">{one.critical || one.alarm ? <span className={`state ${one.state === "reached" ? "error" : "warn"}`}>{one.says}</span> : one.says}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
    <WearPlot one={shown} />
    </>
  );
}

function Modules({ subjects }: { subjects: Shapes["SubjectHealth"][] }): ReactNode {
  const unit = useUnit();
  return (
    <table>
      <thead>
        <tr>
          <th scope="col">Module or function</th>
          <th scope="col" className="number">λ nominal</th>
          <th scope="col" className="number">λ sensor-based</th>
          <th scope="col" className="number">R nominal</th>
          <th scope="col" className="number">R sensor-based</th>
          <th scope="col" className="number">Remaining life</th>
          <th scope="col">Flags</th>
        </tr>
      </thead>
      <tbody>
        {subjects.slice(1).map((one) => (
          <tr key={`${one.kind} ${one.path}`}>
            <th scope="row" style={{ paddingLeft: 10 + 16 * one.path.split("/").length - 16 }}>
              {one.kind === "module" ? <a href={`#/design/${encodeURI(one.path)}`}>{one.name}</a> : `${one.name} (function)`}
            </th>
            <td className="number" data-label="λ nominal">{marked(one.unknown, "hazard_rate", rateText(one.nominal.hazard_rate, unit))}</td>
            <td className="number" data-label="λ sensor-based">{marked(one.unknown, "hazard_rate", rateText(one.sensor_based.hazard_rate, unit))}</td>
            <td className="number" data-label="R nominal">{marked(one.unknown, "reliability", percentText(one.nominal.reliability, one.nominal.unreliability, one.sensor_based.unreliability))}</td>
            <td className="number" data-label="R sensor-based">{marked(one.unknown, "reliability", percentText(one.sensor_based.reliability, one.sensor_based.unreliability, one.nominal.unreliability))}</td>
            <td className="number" data-label="Remaining life">{one.sensor_based.remaining_life ? marked(one.unknown, "ahead", durationText(one.sensor_based.remaining_life.median)) : "–"}</td>
            <td>{one.flags.join(", ")}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
