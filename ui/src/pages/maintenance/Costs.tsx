import { type ReactNode, useEffect, useState } from "react";
import { get, post, type Shapes } from "../../lib/api";
import { say, sayError } from "../../lib/store";
import { durationText, numberText, percentText } from "../../lib/words";
import { Area, FileButton, Text } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Table } from "../../parts/Table";
import type { Upkeep } from "../Maintenance";

const EXAMPLE = "part,preventive,corrective,corrective downtime\n";

/** The best plan for stated costs, beside what is done where only what has failed is replaced. */
export function Costs({ kept, state, set }: { kept: string; state: number; set: (found: Upkeep) => void }): ReactNode {
  const [text, setText] = useState(kept || EXAMPLE);
  const [hour, setHour] = useState("0");
  const [plan, setPlan] = useState<Shapes["MaintenancePlan"] | null>(null);
  const down = Number(hour);
  const wrong = !(hour.trim() && down >= 0 && down <= 1e12);
  useEffect(() => {
    setPlan(null);
    if (!kept || wrong) return;
    const asked = new AbortController();
    get("/api/maintenance/plan", { hour_down: down }, asked.signal).then(setPlan).catch((error: unknown) => !asked.signal.aborted && sayError(error));
    return () => asked.abort();
  }, [kept, state, down, wrong]);

  async function keep(said: string): Promise<void> {
    try {
      set(await post("/api/maintenance/costs", { text: said }));
      setText(said || EXAMPLE);
      say(said ? "Costs are kept beside the design" : "No costs are kept");
    } catch (error) {
      sayError(error);
    }
  }

  return (
    <section className="card" style={{ marginTop: 16 }}>
      <h2>Best plan for its costs</h2>
      {plan && <Plan plan={plan} />}
      <details open={!kept}>
        <summary>Costs of parts</summary>
        <Area label="Table of costs, comma-separated: part, preventive, corrective, and more" rows={6} value={text} set={setText} />
        <div className="row">
          <OnlyFor role="editor">
            <button className="primary" disabled={!text.trim() || text === kept || text === EXAMPLE} onClick={() => void keep(text)}>
              Keep costs
            </button>
            <FileButton label="From a file…" accept=".csv,text/csv" take={(file) => void file.text().then(setText)} />
            {kept && <button onClick={() => void keep("")}>Remove</button>}
          </OnlyFor>
        </div>
      </details>
      {kept && <Text label="An hour of standstill costs" inputMode="decimal" value={hour} set={setHour} wrong={wrong ? "expected a cost of 0 or more" : undefined} />}
    </section>
  );
}

function Plan({ plan }: { plan: Shapes["MaintenancePlan"] }): ReactNode {
  return (
    <>
      <Table label="Best plan" columns={["Part", ["Replace every", "number"], ["Due in", "number"], ["Cost per 1000 h", "number"], ["Only when failed", "number"]]}>
        {plan.parts.map((one) => (
          <tr key={one.part}>
            <td>{one.part}</td>
            <td className="number">{one.every == null ? "never by age" : durationText(one.every)}</td>
            <td className="number">{one.due == null ? "–" : one.due <= 0 ? "now" : durationText(one.due)}</td>
            <td className="number">{numberText(1000 * one.cost, 3)}</td>
            <td className="number">{numberText(1000 * one.never, 3)}</td>
          </tr>
        ))}
        {plan.unknown.map((name) => (
          <tr key={name}>
            <td>{name}</td>
            <td className="number">unknown</td>
            <td className="number">–</td>
            <td className="number">–</td>
            <td className="number">–</td>
          </tr>
        ))}
      </Table>
      {plan.today && plan.best && (
        <Table label="Costs of both ways" caption={`Over ${durationText(plan.hours)} of one robot, ${plan.repetitions} simulated lives`} columns={["", ["Cost, mean", "number"], ["90 % between", "number"], ["Available", "number"], ["Failures", "number"], ["Replaced before", "number"]]}>
          <Years name="Today: only what fails" of={plan.today} />
          <Years name="Best plan: by age" of={plan.best} />
        </Table>
      )}
    </>
  );
}

function Years({ name, of }: { name: string; of: Shapes["YearsOfUpkeep"] }): ReactNode {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td className="number">{numberText(of.cost)} ± {numberText(of.error, 2)}</td>
      <td className="number">{numberText(of.low)} … {numberText(of.high)}</td>
      <td className="number">{percentText(of.availability)}</td>
      <td className="number">{numberText(of.failures, 3)}</td>
      <td className="number">{numberText(of.replacements, 3)}</td>
    </tr>
  );
}
