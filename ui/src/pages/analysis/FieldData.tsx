import { type ReactNode, useState } from "react";
import { type Shapes, upload } from "../../lib/api";
import { FileButton } from "../../parts/Field";
import { Found, messageOf, Trouble } from "./Found";

const TABLES = [
  ["/api/analysis/learned", "Failures in the field", "Choose a failure log", "What a log of failures says of the rates of this design; its columns are those of robophm learn."],
  ["/api/analysis/fits", "Life data", "Choose a table of lives", "Life distributions, the best first; columns: time, censored, count."],
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

function FromTable({ table: [route, title, label, words] }: { table: (typeof TABLES)[number] }): ReactNode {
  const [name, setName] = useState("");
  const [found, setFound] = useState<Shapes["FoundTables"] | null>(null);
  const [wrong, setWrong] = useState("");
  const [busy, setBusy] = useState(false);
  async function take(file: File): Promise<void> {
    setName(file.name);
    setFound(null);
    setWrong("");
    setBusy(true);
    try {
      setFound(await upload(route, file, { name: file.name }));
    } catch (error) {
      setWrong(messageOf(error));
    }
    setBusy(false);
  }
  return (
    <>
      <section className="card" aria-label={title}>
        <h2>{title}</h2>
        <div className="row">
          <FileButton label={name ? `Replace ${name}` : label} accept=".csv,.yaml,.yml" take={(file) => void take(file)} />
          <span className="small quiet">{busy ? "Computing…" : `${words} Nothing is changed.`}</span>
        </div>
      </section>
      <Trouble>{wrong}</Trouble>
      {found && <Found found={found} />}
    </>
  );
}
