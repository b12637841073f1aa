import type { ReactNode } from "react";
import { type Alarm, useAlarms } from "../lib/alarms";
import { post } from "../lib/api";
import { useHealth } from "../lib/health";
import { prefer, preferences, sayError, useShared } from "../lib/store";
import { visitor } from "../lib/access";
import { useNoticesWanted, wantNotices } from "../lib/notices";
import { durationText, momentText } from "../lib/words";
import { Check, Text } from "../parts/Field";
import { Icon, ICONS } from "../parts/Icon";
import { OnlyFor } from "../parts/OnlyFor";

export const page = { name: "Alarms", icon: ICONS.bell, order: 55 };

export default function Alarms(): ReactNode {
  const { health } = useHealth();
  const [found, setFound] = useAlarms();
  const notices = useNoticesWanted();
  const { name: typed } = useShared(preferences);
  const who = useShared(visitor);
  const name = who?.name || typed.trim();
  const going = found?.alarms.filter((one) => one.end == null) ?? [];
  const ended = found?.alarms.filter((one) => one.end != null) ?? [];
  const worst = [...going].sort((a, b) => Number(b.severity === "error") - Number(a.severity === "error") || a.begin - b.begin);

  async function acknowledge(one: Alarm): Promise<void> {
    try {
      setFound(await post("/api/alarms/acknowledge", { number: one.number, by: name }));
    } catch (error) {
      sayError(error);
    }
  }

  return (
    <>
      <div className="head">
        <h1>Alarms</h1>
        <span className="quiet small">{found && (`${going.length || "none"} active`)}</span>
        <span className="grow" />
        <Check label="notify on this desktop" value={notices} set={(wanted) => void wantNotices(wanted)} />
      </div>
      {health && !health.limits_set && (
        <p>
          No limits are set, so no figure can begin an alarm. <a href="#/settings">Set limits</a> of the robot, or of parts and signals in the design's text.
        </p>
      )}
      {health && health.monitoring !== "running" && <p className="quiet">The robot is not watched: alarms neither begin nor end meanwhile.</p>}
      {going.length > 0 && health?.sentence && (
        <p className="answer">
          {health.sentence.replaceAll(" %", "\u00a0%")} <a href="#/overview">Why</a>
        </p>
      )}
      {found && (
        <section className="card">
          <div className="row">
            <h2>Active</h2>
            <span className="grow" />
            {going.length > 0 && who?.name === "" && <Text label="Acknowledge as" placeholder="your name" value={typed} set={(said) => prefer({ name: said })} />}
          </div>
          <Log alarms={worst} now={health?.time} none="None at present." label="Active alarms" acknowledge={name ? (one) => void acknowledge(one) : null} />
        </section>
      )}
      {found && found.limits.length > 0 && (
        <section className="card" style={{ marginTop: 16 }}>
          <h2>What begins one</h2>
          <ul className="alarms" aria-label="Limits of the design">
            {found.limits.map((one, i) => (
              <li key={i}>
                <span className={`state ${one.severity}`}>
                  <Icon name={one.severity} /> {one.severity.toUpperCase()}
                </span>
                <span className="grow">
                  <strong>{one.of || "the robot"}</strong>: {one.rule}
                </span>
              </li>
            ))}
          </ul>
          <p className="small quiet">
            Wear that reaches its threshold, and signals that change or are doubtful, begin one too. Limits are part of the design: <a href="#/settings">those of the robot</a>, all others in its text.
          </p>
        </section>
      )}
      {ended.length > 0 && (
        <section className="card" style={{ marginTop: 16 }}>
          <h2>Cleared</h2>
          <Log alarms={ended} none="" label="Cleared alarms" />
        </section>
      )}
    </>
  );
}

function Log({ alarms, now, none, label, acknowledge }: { alarms: Alarm[]; now?: number | null; none: string; label: string; acknowledge?: ((one: Alarm) => void) | null }): ReactNode {
  if (!alarms.length) return <p className="quiet">{none}</p>;
  return (
    <ul className="alarms" aria-label={label}>
      {alarms.map((one) => (
        <li key={one.number}>
          <span className={`state ${one.severity}`}>
            <Icon name={one.severity} /> {one.severity.toUpperCase()}
          </span>
          <div className="grow">
            <strong>{one.cause}</strong>
            {one.doubt && one.end == null && <p className="small">Not known whether it is still so: it {one.doubt}.</p>}
            <p className="small quiet">
              since <a href={`#/history/${one.begin}`} title="The robot as it was then">{momentText(one.begin)}</a>
              {one.end == null && now != null && now > one.begin && `, for ${durationText((now - one.begin) / 3600)}`}
              {one.end != null && `, until ${momentText(one.end)}: ${one.ended_by}`}
            </p>
          </div>
          {one.acknowledged_by ? (
            <span className="small quiet" title={momentText(one.acknowledged_at)}>
              acknowledged by {one.acknowledged_by}
            </span>
          ) : (
            acknowledge !== undefined && (
              <OnlyFor role="operator">
                <button disabled={!acknowledge} title={acknowledge ? undefined : "Say who you are first"} onClick={() => acknowledge?.(one)} aria-label={`Acknowledge alarm ${one.number}`}>
                  Acknowledge
                </button>
              </OnlyFor>
            )
          )}
        </li>
      ))}
    </ul>
  );
}
