import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { useHealth } from "../lib/health";
import { sayError, useDesign } from "../lib/store";
import { durationText, momentText, moreText, numberText } from "../lib/words";
import { Select } from "../parts/Field";
import { OnlyFor } from "../parts/OnlyFor";
import { Table } from "../parts/Table";
import { Costs } from "./maintenance/Costs";
import { ServiceDialog } from "./maintenance/ServiceDialog";

export const page = {
  name: "Maintenance",
  icon: "M14 6a4 4 0 0 1 5-3l-3 3 2 2 3-3a4 4 0 0 1-5 5l-8 8a2 2 0 0 1-3-3z",
  order: 56,
};

export type Upkeep = Shapes["Maintenance"];
export type Due = Shapes["DuePart"];

const RISKS: [string, string][] = [["0.01", "1 %"], ["0.05", "5 %"], ["0.1", "10 %"], ["0.2", "20 %"], ["0.5", "50 %"]];

const REFRESHED_EVERY = 30_000;

/** What is due, asked for when the page opens, when the design or the state of watching changes, and twice a minute. */
function useUpkeep(risk: string): [Upkeep | null, (found: Upkeep) => void, () => void] {
  const design = useDesign();
  const { health } = useHealth();
  const [found, setFound] = useState<Upkeep | null>(null);
  const [again, setAgain] = useState(0);
  useEffect(() => {
    if (!design?.valid) return;
    const asked = new AbortController();
    const ask = (): void => {
      get("/api/maintenance", { risk }, asked.signal).then(setFound).catch((error: unknown) => !asked.signal.aborted && sayError(error));
    };
    ask();
    const timer = setInterval(ask, REFRESHED_EVERY);
    return () => {
      clearInterval(timer);
      asked.abort();
    };
  }, [design?.state, design?.valid, health?.monitoring, health?.alarms, risk, again]);
  return [found, setFound, () => setAgain((count) => count + 1)];
}

export default function Maintenance(): ReactNode {
  const design = useDesign();
  const [risk, setRisk] = useState("0.05");
  const [serving, setServing] = useState<Due | null>(null);
  const [found, setFound, ask] = useUpkeep(risk);
  const listed = found?.due.filter((one) => one.state !== "useless") ?? [];
  const useless = found?.due.filter((one) => one.state === "useless") ?? [];
  return (
    <>
      <div className="head">
        <h1>Maintenance</h1>
        <span className="quiet small">{found && (found.time == null ? "of the robot as it is when new" : `as of ${momentText(found.time)}`)}</span>
        <span className="grow" />
        <Select label="Accepted chance of failure" value={risk} options={RISKS} set={setRisk} />
        <a className="button" href={`./api/maintenance/maintenance.ics?risk=${risk}`} title="iCalendar; calendars can subscribe to this address">
          Calendar (iCal)
        </a>
      </div>
      {design && !design.valid && <p className="trouble">The design is not complete yet: nothing can be said of its upkeep.</p>}
      {!found && design?.valid && <p className="quiet">…</p>}
      {found && (
        <>
          <p className="answer-line" role="status">
            <strong>{first(listed)}</strong>
          </p>
          {found.silence && <p className="trouble">What is due {found.silence}.</p>}
          {!found.past && <p className="quiet">Nothing has been watched yet: services can be noted once the robot has a past.</p>}
          {listed.length > 0 && (
            <section className="card">
              <h2>Due</h2>
              <ul className="alarms" aria-label="Parts that are due">
                {listed.map((one) => (
                  <DueItem key={one.part} one={one} serve={found.past ? () => setServing(one) : undefined} />
                ))}
              </ul>
              {found.others > 0 && <p className="small quiet">{moreText(found.others)}: they do not wear, or are less likely to fail within a year.</p>}
            </section>
          )}
          {useless.length > 0 && (
            <details className="card" style={{ marginTop: 16 }} open={!listed.length}>
              <summary>
                {useless.length === 1 ? "1 part does not wear" : `${useless.length} parts do not wear`}: replacing before a failure gains nothing
              </summary>
              <Table label="Parts that do not wear" className="scroll stacked" columns={["Part", ["90 % fail within", "number"], ["Service", "spoken"]]}>
                {useless.map((one) => (
                  <tr key={one.part}>
                    <td>{named(one)}</td>
                    <td className="number" data-label="90 % fail within">{between(one)}</td>
                    <td><Serve one={one} serve={found.past ? () => setServing(one) : undefined} /></td>
                  </tr>
                ))}
              </Table>
            </details>
          )}
          <Spares found={found} />
          <Costs kept={found.costs} state={design?.state ?? 0} set={setFound} />
          <Done found={found} />
        </>
      )}
      {serving && <ServiceDialog due={serving} close={() => setServing(null)} done={ask} />}
    </>
  );
}

/** What to replace first, and when, in one sentence. */
function first(listed: Due[]): string {
  const one = listed.find((due) => due.due != null);
  if (!one) return "No part is due by age: none that has a rate wears out.";
  const also = listed.filter((due) => due.due === 0).length - 1;
  if (one.due === 0) return `Replace ${one.part} now${also > 0 ? `, and ${also} more` : ""}: ${one.why}.`;
  return `Replace ${one.part} first, within ${durationText(one.due)}: ${one.why}.`;
}

function named(one: Due): ReactNode {
  return (
    <a href={`#/design/${encodeURI(one.part)}`}>
      {one.part}
      {one.quantity > 1 && ` ×${one.quantity}`}
    </a>
  );
}

function between(one: Due): string {
  if (one.early == null || one.state === "now") return "–";
  return `${durationText(one.early)} … ${durationText(one.late)}`;
}

const NEVER = { unknown: "unknown", useless: "never", still: "never", now: "now", ahead: "" };

function DueItem({ one, serve }: { one: Due; serve?: () => void }): ReactNode {
  return (
    <li>
      <strong className={one.state === "now" ? "state error" : "due"}>{one.due && one.state === "ahead" ? durationText(one.due) : NEVER[one.state]}</strong>
      <div className="grow">
        <strong>{named(one)}</strong>
        <p>
          {one.why}
          {!one.alone && ", told as if the parts that it depends on all worked"}
        </p>
        <p className="small quiet">
          {one.state === "ahead" && `fails within ${between(one)} (90 %), median ${durationText(one.median)}`}
          {one.served && ` · ${one.served.kind} ${momentText(one.served.time)}${one.served.by ? ` by ${one.served.by}` : ""}`}
        </p>
      </div>
      <Serve one={one} serve={serve} />
    </li>
  );
}

function Serve({ one, serve }: { one: Due; serve?: () => void }): ReactNode {
  return (
    <OnlyFor role="operator">
      <button disabled={!serve} title={serve ? undefined : "The robot has no past yet"} onClick={serve} aria-label={`Note a service of ${one.part}`}>
        Note a service
      </button>
    </OnlyFor>
  );
}

function Spares({ found }: { found: Upkeep }): ReactNode {
  const spans = [...new Set(found.replacements.map((one) => one.hours))];
  const longest = found.replacements.filter((one) => one.hours === spans.at(-1));
  const of = (name: string, hours: number): Upkeep["replacements"][number] | undefined => found.replacements.find((one) => one.name === name && one.hours === hours);
  const MOST = 30;
  return (
    <section className="card" style={{ marginTop: 16 }}>
      <h2>Replacements to come</h2>
      <p className="small quiet">Mean number, and between which it is with 90 %, where what has failed is replaced at once. What is replaced before it fails is not in it.</p>
      <Table label="Replacements to come" className="scroll stacked" columns={["Type of part", ["Parts", "number"], ...spans.map((hours): [string, "number"] => [durationText(hours), "number"])]}>
        {longest.slice(0, MOST).map((one) => (
          <tr key={one.name}>
            <td title={one.parts.join(", ")}>{one.name}</td>
            <td className="number" data-label="Parts">{one.count}</td>
            {spans.map((hours) => {
              const within = of(one.name, hours);
              return (
                <td key={hours} className="number" data-label={durationText(hours)}>
                  {within?.expected == null ? "unknown" : `${numberText(within.expected, 2)} (${within.low} … ${within.high})`}
                </td>
              );
            })}
          </tr>
        ))}
      </Table>
      {longest.length > MOST && <p className="small quiet">{moreText(longest.length - MOST)}: fewer are expected of them.</p>}
    </section>
  );
}

function Done({ found }: { found: Upkeep }): ReactNode {
  return (
    <section className="card" style={{ marginTop: 16 }}>
      <h2>Done</h2>
      {!found.services.length && <p className="quiet">No service has been noted.</p>}
      {found.services.length > 0 && (
        <Table label="Services so far" className="scroll stacked" columns={["When", "Part", "What", "By", "Note"]}>
          {found.services.map((one, i) => (
            <tr key={i}>
              <td>{one.time == null ? "before its first recording" : momentText(one.time)}</td>
              <td>{one.mode}</td>
              <td>
                {one.kind}
                {one.failed && one.kind !== "failed" && " after it had failed"}
              </td>
              <td data-label="By">{one.by || "–"}</td>
              <td data-label="Note">{one.note || "–"}</td>
            </tr>
          ))}
        </Table>
      )}
    </section>
  );
}
