import { type ReactNode, useState } from "react";
import type { Shapes } from "../../lib/api";
import { useShared, useUnit } from "../../lib/store";
import { numberText, RATE_UNITS, type RateUnit, rateText } from "../../lib/words";
import { Entry, Text } from "../../parts/Field";
import { Table } from "../../parts/Table";
import { change, handed, said } from "./state";

type Part = Shapes["ProposedPart"];

const GRADES: Record<string, string> = { A: "a figure of a maker", B: "a handbook or rule", C: "an estimate" };

function rate(one: Part, unit: RateUnit): string {
  const { factor } = RATE_UNITS[unit];
  const stated = one.rate == null ? "unknown" : rateText(one.rate, unit);
  return one.low == null || one.high == null ? stated : `${stated} (${numberText(one.low * factor, 2)} … ${numberText(one.high * factor, 2)}${unit === "MTBF" ? " /h" : ""})`;
}

const topics = (signals: string[]): string => [...new Set(signals.map((one) => one.split(".")[0]))].join(", ") || "–";

/** The parts of a draft, each to be taken for another entry of the library, or left out. */
export function Proposed({ parts }: { parts: Part[] }): ReactNode {
  const unit = useUnit();
  const { parts: changes } = useShared(said);
  const found = useShared(handed);
  const [name, setName] = useState("");
  const [words, setWords] = useState("");
  const put = (part: string, as: string): void => {
    if (part.trim() && as.trim()) change({ parts: [...changes, { part: part.trim(), words: as.trim() }] });
  };
  return (
    <section className="card">
      <h2>3. Its parts{parts.length > 0 && ` (${parts.length})`}</h2>
      <p className="small quiet">
        Each is taken for an entry of the library: type another, or words for one (rplidar a1, harmonic drive). Grade A is {GRADES.A}, B {GRADES.B}, C {GRADES.C}.
      </p>
      <datalist id="entries">
        {found?.library.map((one) => (
          <option key={one.name} value={one.name}>
            {one.title}
          </option>
        ))}
      </datalist>
      <Table label="Parts of the draft" className="scroll stacked" columns={["Part", "Taken for", [`λ, 5 … 95 % [${RATE_UNITS[unit].axis}]`, "number"], "Grade", "Why it is there", "Answers to", "Listens to", ["Leave out", "spoken"]]}>
        {parts.map((one) => (
          <tr key={one.path}>
            <th scope="row">
              {one.path}
              {one.quantity > 1 && ` ×${one.quantity}`}
            </th>
            <td data-label="Taken for">
              {one.entry ? <Entry key={one.entry} spoken label={`What ${one.path} is`} list="entries" value={one.entry} set={(as) => put(one.path, as)} hint={one.title} /> : one.title}
            </td>
            <td className="number" data-label="λ">{rate(one, unit)}</td>
            <td data-label="Grade">
              <abbr title={one.source}>{one.grade || "–"}</abbr>
            </td>
            <td className="small" data-label="Why">
              {one.seen}
              {one.assumed && <span className="quiet">; assumed: {one.assumed}</span>}
            </td>
            <td className="small" data-label="Answers to">{one.stresses.join(", ") || "–"}</td>
            <td className="small" data-label="Listens to">{topics(one.signals)}</td>
            <td>
              {one.entry && (
                <button className="plain" aria-label={`Leave out ${one.path}`} onClick={() => put(one.path, "none")}>
                  Leave out
                </button>
              )}
            </td>
          </tr>
        ))}
      </Table>
      <form
        className="fields"
        onSubmit={(event) => {
          event.preventDefault();
          put(name, words);
          setName("");
          setWords("");
        }}
      >
        <Text label="Another part" placeholder="sensing/front lidar" value={name} set={setName} />
        <Text label="What it is" list="entries" placeholder="words, or an entry" value={words} set={setWords} />
        <div className="row">
          <button type="submit" disabled={!name.trim() || !words.trim()}>
            Add part
          </button>
        </div>
      </form>
      {changes.length > 0 && (
        <div className="row" role="group" aria-label="What you have changed">
          <span className="small quiet">Changed by you:</span>
          {changes.map((one, i) => (
            <button key={i} className="small" aria-label={`Take back: ${one.part} ${one.words}`} onClick={() => change({ parts: changes.filter((_, n) => n !== i) })}>
              {one.part}: {one.words === "none" ? "left out" : one.words} ×
            </button>
          ))}
        </div>
      )}
    </section>
  );
}
