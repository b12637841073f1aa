import { type ReactNode, useMemo, useState } from "react";
import type { Operation } from "../../lib/api";
import { cell, offer } from "../../lib/exports";
import { edit, go, useDesign, useUnit } from "../../lib/store";
import { everyPart, findPart, freeName, insteadOfRate, isValues, type Part, treeOf } from "../../lib/tree";
import { marked, rateText } from "../../lib/words";
import { Dialog } from "../../parts/Dialog";
import { Area, useTyping } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Table } from "../../parts/Table";
import { LevelSelect } from "./LevelSelect";

const MOST = 500;

export function PartsTable(): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const [text, setText] = useState("");
  const [paste, setPaste] = useState(false);
  const parts = useMemo(() => (design ? [...everyPart(treeOf(design))].filter((one) => one.kind === "component") : []), [design]);
  if (!design) return null;
  const words = text.toLowerCase();
  const shown = parts.filter((one) => one.path.toLowerCase().includes(words));
  const number = (value: string): unknown => (/^\d+$/.test(value.trim()) ? Number(value) : value);
  const set = (part: Part, key: string, value: unknown): void => void edit([{ op: "put", path: [...part.place, key], value }], `${key} of ${part.name}`);
  return (
    <>
      <div className="row" style={{ marginBottom: 10 }}>
        <input type="search" aria-label="Find a part" placeholder="Find a part" value={text} onChange={(event) => setText(event.target.value)} />
        <OnlyFor role="editor">
          <button onClick={() => setPaste(true)}>Paste from a spreadsheet…</button>
        </OnlyFor>
        <button onClick={() => offer(`${design.name} parts.csv`, "text/csv", csv(parts, design.levels, design.unknown))}>Parts as CSV</button>
        <span className="quiet small">
          {shown.length} of {parts.length}
        </span>
      </div>
      {!parts.length && <p>No parts yet. Add them in Design, from the library, or import a list.</p>}
      {parts.length > 0 && (
        <Table className="scroll card" label="Parts" columns={["Part", "Quantity", "Rate of one, or its model", ["λ of all, new", "number"], "Life", "Source"]}>
          {shown.slice(0, MOST).map((part) => (
            <tr key={part.path}>
              <th scope="row">
                <button className="plain" onClick={() => go("design", part.path)} title="Open in Design">
                  {part.path}
                </button>
              </th>
              <td>
                <Cell label={`Quantity of ${part.path}`} value={String(part.values.quantity ?? 1)} set={(value) => set(part, "quantity", number(value))} />
              </td>
              <td>{stated(part) ?? <Cell label={`Rate of ${part.path}`} value={String(part.values.rate ?? "")} set={(value) => set(part, "rate", value)} />}</td>
              <td className="number">{marked(design.unknown[part.path], "hazard_rate", rateText(design.levels[part.path]?.hazard_rate, unit))}</td>
              <td>{isValues(part.values.life) ? String(part.values.life.distribution) : part.values.part ? "as in the library" : "exponential"}</td>
              <td>{source(part)}</td>
            </tr>
          ))}
        </Table>
      )}
      {shown.length > MOST && <p className="quiet">{shown.length - MOST} more: find them by name.</p>}
      {paste && <Paste close={() => setPaste(false)} />}
    </>
  );
}

function Cell({ label, value, set }: { label: string; value: string; set: (value: string) => void }): ReactNode {
  const typing = useTyping(value, set);
  return (
    <OnlyFor role="editor">
      <input
        aria-label={label}
        value={typing.text}
        onChange={(event) => typing.type(event.target.value)}
        onBlur={typing.finish}
        onKeyDown={(event) => {
          if (event.key === "Enter") event.currentTarget.blur();
          if (event.key === "Escape") typing.drop();
        }}
      />
      {typing.meanwhile && <span className="small wrong" role="alert">{typing.meanwhile}</span>}
    </OnlyFor>
  );
}

function stated(part: Part): string | null {
  if (isValues(part.values.failure_modes) && Object.keys(part.values.failure_modes).length) return `${Object.keys(part.values.failure_modes).length} failure modes`;
  const hazard = part.values.hazard;
  if (isValues(hazard) && hazard.formula) return String(hazard.formula);
  return insteadOfRate(part.values) || null;
}

function source(part: Part): string {
  const hazard = part.values.hazard;
  return String(part.values.source ?? (isValues(hazard) ? (hazard.source ?? (hazard.model ? "handbook" : "")) : part.values.part && part.values.rate === undefined ? "library" : ""));
}

function csv(parts: Part[], levels: Record<string, { hazard_rate: number | null }>, unknown: Record<string, unknown>): string {
  const rows = parts.map((part) => [part.path, String(part.values.quantity ?? 1), String(part.values.rate ?? stated(part) ?? ""), unknown[part.path] ? "unknown" : String(levels[part.path]?.hazard_rate ?? ""), source(part)]);
  return [["part", "quantity", "rate of one", "hazard rate of all when new [1/h]", "source"], ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

/** Rows of name, quantity and rate, as a spreadsheet copies them. */
function Paste({ close }: { close: () => void }): ReactNode {
  const design = useDesign();
  const [text, setText] = useState("");
  const [level, setLevel] = useState("");
  const rows = text
    .split(/\r?\n/)
    .map((line) => line.split(line.includes("\t") ? "\t" : ";").map((one) => one.trim()))
    .filter((row) => row[0]);
  const bad = rows.filter((row) => row.length < 3 || !/^\d+$/.test(row[1] ?? ""));
  const host = design && findPart(design, level);
  function take(): void {
    if (!host) return;
    const taken: Part = { ...host, parts: [...host.parts] };
    const operations: Operation[] = rows.map(([said = "", quantity, rate]) => {
      const name = freeName(taken, said.replace(/[/[\]]/g, "-"));
      taken.parts.push({ ...host, name, parts: [] });
      return { op: "put", path: [...host.place, "components", name], value: { quantity: Number(quantity), rate } };
    });
    void edit(operations, `Paste ${rows.length} parts`);
    close();
  }
  return (
    <Dialog title="Paste parts from a spreadsheet" close={close}>
      <p className="small quiet">A row for each part: name, quantity, rate of one with its unit (9.36e-6 /h, 12 FIT), with tabs between, as a spreadsheet copies them.</p>
      <LevelSelect label="Into" value={level} set={setLevel} />
      <Area label="Rows" rows={10} value={text} set={setText} wrong={bad.length ? `row "${bad[0]!.join(" | ")}": expected a name, a whole number and a rate` : ""} />
      <button className="primary" disabled={!rows.length || bad.length > 0} onClick={take}>
        Add {rows.length} parts
      </button>
    </Dialog>
  );
}
