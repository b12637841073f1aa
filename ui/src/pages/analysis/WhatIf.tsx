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

/** The design now beside what it would be; nothing is changed until somebody says so. */
export function WhatIf(): ReactNode {
  const design = useDesign();
  const [path, setPath] = useState("");
  const [kind, setKind] = useState("rate");
  const [value, setValue] = useState("");
  const [log, setLog] = useState(false);
  const [found, setFound] = useState<Shapes["WhatIf"] | null>(null);
  const [wrong, setWrong] = useState("");
  const part = design && findPart(design, path);

  function operations(): Operation[] {
    if (!part || !part.path) return [];
    if (kind === "delete") return [{ op: "delete", path: part.place }];
    const written = kind === "rate" ? value : Number(value);
    return [...(kind === "rate" && part.values.hazard !== undefined ? [{ op: "delete" as const, path: [...part.place, "hazard"] }] : []), ...change(part, [kind], written)];
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

  const ready = operations().length > 0 && (kind === "delete" || !!value);
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
        <div className="row">
          <button className="primary" type="submit" disabled={!ready}>
            Compare
          </button>
          <OnlyFor role="editor">
            <button type="button" disabled={!found} onClick={() => void edit(operations(), `What if: ${kind} of ${part?.name ?? ""}`).then(() => setFound(null))}>
              Make it so
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
