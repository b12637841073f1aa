import { type ReactNode, useState } from "react";
import { type Operation, post, type Shapes } from "../../lib/api";
import { edit, useDesign } from "../../lib/store";
import { change, findPart } from "../../lib/tree";
import { Check, Select, Text } from "../../parts/Field";
import { LevelSelect } from "../parts/LevelSelect";
import { CurvePlots } from "./CurvePlots";
import { OnlyFor } from "../../parts/OnlyFor";

const CHANGES: [string, string][] = [
  ["rate", "another stated rate"], ["quantity", "another quantity"], ["required", "so many of them must work"], ["delete", "without it"],
];

const wordsOf = (path: string, kind: string, value: string): string =>
  kind === "delete" ? `without ${path}` : `${path}: ${kind === "rate" ? "a rate of" : kind === "quantity" ? "a quantity of" : "of which must work"} ${value}`;

/** The design now beside what it would be; nothing is changed until somebody says so. */
export function WhatIf(): ReactNode {
  const design = useDesign();
  const [path, setPath] = useState("");
  const [kind, setKind] = useState("rate");
  const [value, setValue] = useState("");
  const [log, setLog] = useState(false);
  const [also, setAlso] = useState<{ words: string; path: string; kind: string; value: string }[]>([]);
  const [found, setFound] = useState<Shapes["WhatIf"] | null>(null);
  const [wrong, setWrong] = useState("");

  function operationsOf(of: string, kind: string, value: string): Operation[] {
    const part = design && findPart(design, of);
    if (!part?.path) return [];
    if (kind === "delete") return [{ op: "delete", path: part.place }];
    const written = kind === "rate" ? value : Number(value);
    return [...(kind === "rate" && part.values.hazard !== undefined ? [{ op: "delete" as const, path: [...part.place, "hazard"] }] : []), ...change(part, [kind], written)];
  }
  const stated = kind === "delete" || !!value;
  const last = stated ? operationsOf(path, kind, value) : [];
  const operations = (): Operation[] => [...also.flatMap((one) => operationsOf(one.path, one.kind, one.value)), ...last];
  const words = [...also.map((one) => one.words), ...(last.length ? [wordsOf(path, kind, value)] : [])];

  function andAlso(): void {
    setAlso([...also, { words: wordsOf(path, kind, value), path, kind, value }]);
    setPath("");
    setValue("");
  }

  async function ask(): Promise<void> {
    try {
      setFound(await post("/api/analysis/what-if", { operations: operations(), path: "", horizon: null }));
      setWrong("");
    } catch (error) {
      setFound(null);
      setWrong(error instanceof Error ? error.message : String(error));
    }
  }

  return (
    <>
      <form
        className="card"
        style={{ marginBottom: 16 }}
        onSubmit={(event) => {
          event.preventDefault();
          void ask();
        }}
      >
        <div className="fields">
          <LevelSelect label="What if this part" value={path} set={setPath} parts />
          <Select label="had" value={kind} set={setKind} options={CHANGES} />
          {kind !== "delete" && <Text label={kind === "rate" ? "Rate of one" : "How many"} placeholder={kind === "rate" ? "e.g. 0.5 FPMH" : ""} value={value} set={setValue} />}
          <Check label="show 1 − R, logarithmic" value={log} set={setLog} />
        </div>
        {also.length > 0 && (
          <ul aria-label="Changes that are compared together">
            {also.map((one, i) => (
              <li key={i}>
                {one.words}{" "}
                <button type="button" className="plain" aria-label={`Remove: ${one.words}`} onClick={() => setAlso(also.filter((_, other) => other !== i))}>
                  Remove
                </button>
              </li>
            ))}
          </ul>
        )}
        <div className="row">
          <button className="primary" type="submit" disabled={!words.length}>
            Compare
          </button>
          <button type="button" disabled={!last.length} onClick={andAlso}>
            And also…
          </button>
          <OnlyFor role="editor">
            <button type="button" disabled={!found} onClick={() => void edit(operations(), `What if: ${words.join(", ")}`).then(() => { setFound(null); setAlso([]); setPath(""); setValue(""); })}>
              Apply
            </button>
          </OnlyFor>
        </div>
      </form>
      {wrong && (
        <div className="trouble" role="alert">
          {wrong}
        </div>
      )}
      {found && <CurvePlots found={found.changed} other={found.baseline} otherName="baseline" log={log} />}
    </>
  );
}
