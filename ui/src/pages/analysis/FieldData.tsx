import { type ReactNode, useEffect, useState } from "react";
import { type Shapes, upload } from "../../lib/api";
import { replaceText, useDesign } from "../../lib/store";
import { Changed } from "../../parts/Changed";
import { FileButton } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Found, messageOf, Trouble } from "./Found";

const TABLES = [
  ["/api/analysis/learned", "Failures in the field", "Choose a failure log", "What a log of failures says of the rates of this design; its columns are those of robophm learn. Nothing is changed until you use them."],
  ["/api/analysis/fits", "Life data", "Choose a table of lives", "Life distributions, the best first; columns: time, censored, count. Nothing is changed."],
] as const;

/** What failures in the field, and life data, say. */
export function FieldData(): ReactNode {
  return (
    <div className="stack">
      {TABLES.map((one) => (
        <FromTable key={one[0]} table={one} />
      ))}
    </div>
  );
}

type Tables = Shapes["FoundTables"] & Partial<Shapes["LearnedTables"]>;

function FromTable({ table: [route, title, label, words] }: { table: (typeof TABLES)[number] }): ReactNode {
  const design = useDesign();
  const [file, setFile] = useState<File | null>(null);
  const [found, setFound] = useState<Tables | null>(null);
  const [wrong, setWrong] = useState("");
  const [busy, setBusy] = useState(false);
  const [again, setAgain] = useState(0);
  useEffect(() => {
    if (!file) return;
    let wanted = true;
    setBusy(true);
    upload(route, file, { name: file.name })
      .then((one) => {
        if (!wanted) return;
        setFound(one);
        setWrong("");
      })
      .catch((error: unknown) => wanted && setWrong(messageOf(error)))
      .finally(() => wanted && setBusy(false));
    return () => {
      wanted = false;
    };
  }, [file, again, route === "/api/analysis/learned" && design?.state]);
  function take(one: File): void {
    setFile(one);
    setFound(null);
    setWrong("");
  }
  return (
    <>
      <section className="card" aria-label={title}>
        <h2>{title}</h2>
        <div className="row">
          <FileButton label={file ? `Replace ${file.name}` : label} accept=".csv,.yaml,.yml" take={take} />
          <span className="small quiet">{busy ? "Computing…" : words}</span>
        </div>
      </section>
      <Trouble>{wrong}</Trouble>
      {found && <Found found={found} />}
      {found?.text && (
        <section className="card">
          <h2>Into the design</h2>
          <p>The evidence beside each stated rate, which stays:</p>
          <Changed label="What changes in the design" lines={found.changes ?? []} />
          <OnlyFor role="editor">
            <button className="primary" disabled={busy} onClick={() => void replaceText(found.text!, `Rates learned from ${file?.name}`, found.revision, () => setAgain(again + 1))}>
              Use these rates
            </button>
          </OnlyFor>
        </section>
      )}
      {found?.known && <p className="quiet">The design has these rates.</p>}
    </>
  );
}
