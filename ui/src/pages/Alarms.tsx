import type { ReactNode } from "react";
import { type Alarm, useAlarms } from "../lib/alarms";
import { post } from "../lib/api";
import { useHealth } from "../lib/health";
import { prefer, preferences, sayError, useShared } from "../lib/store";
import { momentText } from "../lib/words";
import { Text } from "../parts/Field";
import { Icon, ICONS } from "../parts/Icon";
import { Table } from "../parts/Table";

export const page = { name: "Alarms", icon: ICONS.bell, order: 55 };

export default function Alarms(): ReactNode {
  const { health } = useHealth();
  const [found, setFound] = useAlarms();
  const { name } = useShared(preferences);
  const going = found?.alarms.filter((one) => one.end == null) ?? [];
  const ended = found?.alarms.filter((one) => one.end != null) ?? [];

  async function acknowledge(one: Alarm): Promise<void> {
    try {
      setFound(await post("/api/alarms/acknowledge", { number: one.number, by: name.trim() }));
    } catch (error) {
      sayError(error);
    }
  }

  return (
    <>
      <div className="head">
        <h1>Alarms</h1>
        <span className="quiet small">{found && (going.length ? `${going.length} ${going.length === 1 ? "goes" : "go"} on` : "none goes on")}</span>
      </div>
      {health && !health.limits_set && (
        <p>
          No limits are set, so no figure can begin an alarm. <a href="#/settings">Set limits</a> of the robot, or of parts and signals in the design's text.
        </p>
      )}
      {health && health.monitoring !== "running" && <p className="quiet">The robot is not watched: alarms neither begin nor end meanwhile.</p>}
      {found && (
        <section className="card">
          <h2>Going on</h2>
          {going.length > 0 && <Text label="Acknowledge as" hint="your name" value={name} set={(said) => prefer({ name: said })} />}
          <Log alarms={going} none="Nothing at present." label="Alarms that go on" acknowledge={name.trim() ? (one) => void acknowledge(one) : null} />
        </section>
      )}
      {ended.length > 0 && (
        <section className="card" style={{ marginTop: 16 }}>
          <h2>Over</h2>
          <Log alarms={ended} none="" label="Alarms that are over" />
        </section>
      )}
    </>
  );
}

function Log({ alarms, none, label, acknowledge }: { alarms: Alarm[]; none: string; label: string; acknowledge?: ((one: Alarm) => void) | null }): ReactNode {
  if (!alarms.length) return <p className="quiet">{none}</p>;
  return (
    <Table label={label} columns={["Severity", "Began", "Ended", "Why", "Acknowledged"]}>
      {alarms.map((one) => (
        <tr key={one.number}>
          <td>
            <span className={`state ${one.severity}`}>
              <Icon name={one.severity} /> {one.severity.toUpperCase()}
            </span>
          </td>
          <td>{momentText(one.begin)}</td>
          <td>{one.end != null ? momentText(one.end) : one.doubt ? <span className="state stale">not known</span> : "goes on"}</td>
          <td>
            {one.cause}
            {one.doubt && one.end == null && <div className="small quiet">Whether it goes on is not known: it {one.doubt}.</div>}
            {one.ended_by && <div className="small quiet">{one.ended_by}</div>}
          </td>
          <td>
            {one.acknowledged_by ? (
              <>
                {one.acknowledged_by}
                <div className="small quiet">{momentText(one.acknowledged_at)}</div>
              </>
            ) : acknowledge !== undefined ? (
              <button disabled={!acknowledge} title={acknowledge ? undefined : "Say who you are first"} onClick={() => acknowledge?.(one)} aria-label={`Acknowledge alarm ${one.number}`}>
                Acknowledge
              </button>
            ) : (
              "–"
            )}
          </td>
        </tr>
      ))}
    </Table>
  );
}
