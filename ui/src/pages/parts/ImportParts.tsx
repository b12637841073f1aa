import { type ReactNode, useState } from "react";
import { type Shapes, upload } from "../../lib/api";
import { go, replaceText, sayError } from "../../lib/store";
import { FileButton, Select } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Preview } from "../../parts/Table";
import { LevelSelect } from "./LevelSelect";

/** A parts list, looked at before anything is changed. */
export function ImportParts(): ReactNode {
  const [file, setFile] = useState<File | null>(null);
  const [module, setModule] = useState("");
  const [columns, setColumns] = useState<Record<string, string>>({});
  const [found, setFound] = useState<Shapes["Imported"] | null>(null);
  const [wrong, setWrong] = useState("");

  async function look(taken: File, said: Record<string, string>, into: string): Promise<void> {
    setFile(taken);
    setColumns(said);
    setModule(into);
    try {
      const pairs = Object.entries(said).filter(([, header]) => header).map(([field, header]) => `${field}=${header}`);
      setFound(await upload("/api/imports/parts-list", taken, { name: taken.name, module: into, columns: pairs }));
      setWrong("");
    } catch (error) {
      setFound(null);
      setWrong(error instanceof Error ? error.message : String(error));
    }
  }

  const headers = found ? [...Object.values(found.mapping), ...found.unused] : [];
  return (
    <div className="stack">
      <OnlyFor role="editor">
        <div className="row">
          <FileButton label={file ? `Other list than ${file.name}` : "Choose a parts list"} accept=".csv,.tsv,.xlsx,.ods,.txt" take={(one) => void look(one, {}, module)} />
          <span className="small quiet">.csv, .xlsx or .ods as KiCad, Altium and offices export them. Nothing is changed before you say so.</span>
        </div>
      </OnlyFor>
      {wrong && (
        <div className="trouble" role="alert">
          {wrong}
        </div>
      )}
      {found && file && (
        <>
          <div className="card">
            <h2>What the columns mean</h2>
            <div className="fields">
              <LevelSelect label="Into" value={module} set={(path) => void look(file, columns, path)} />
              {found.fields.map((field) => (
                <Select
                  key={field}
                  label={field.replaceAll("_", " ")}
                  value={found.mapping[field] ?? ""}
                  options={[["", "–"], ...[...new Set(headers)].map((one): [string, string] => [one, one])]}
                  set={(header) => void look(file, { ...columns, [field]: header }, module)}
                />
              ))}
            </div>
          </div>
          <Preview
            className="card scroll"
            label="What becomes of the list"
            caption={`${found.rows.length} rows ${found.findings.join("; ")}`}
            columns={found.columns}
            rows={found.rows}
          />
          <div className="row">
            <button
              className="primary"
              onClick={() =>
                void replaceText(found.text, `Import ${file.name}`)
                  .then((done) => done && go("design", module))
                  .catch(sayError)
              }
            >
              Put {found.rows.length} parts into the design
            </button>
          </div>
        </>
      )}
    </div>
  );
}
