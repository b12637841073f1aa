import { type ReactNode, useState } from "react";
import { file, get, type Shapes, upload } from "../lib/api";
import { offer } from "../lib/exports";
import { go, replaceText, sayError, useDesign } from "../lib/store";
import { Check, FileButton } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { OnlyFor } from "../parts/OnlyFor";
import { Preview } from "../parts/Table";
import { Recordings } from "./reports/Recordings";

export const page = { name: "Reports and data", icon: ICONS.report, order: 80 };

export default function Reports(): ReactNode {
  const design = useDesign();
  const [legacy, setLegacy] = useState<{ name: string; found: Shapes["Imported"] } | null>(null);
  const [wrong, setWrong] = useState("");
  const [printing, setPrinting] = useState(false);
  const [short, setShort] = useState(false);
  if (!design) return null;
  async function print(): Promise<void> {
    setPrinting(true);
    try {
      offer("health.pdf", "application/pdf", await file("/api/report.pdf", { short }));
    } catch (error) {
      sayError(error);
    }
    setPrinting(false);
  }
  const look = (one: File): void =>
    void upload("/api/imports/legacy", one, { name: one.name })
      .then((found) => {
        setLegacy({ name: one.name, found });
        setWrong("");
      })
      .catch((error: Error) => {
        setLegacy(null);
        setWrong(error.message);
      });
  return (
    <>
      <div className="head">
        <h1>Reports and data</h1>
      </div>
      <div className="two">
        <section className="card">
          <h2>Report</h2>
          <p>One page with diagram, tables, curves, importance, sensors and assumptions. It needs nothing else, not even JavaScript, and prints well.</p>
          {design.valid ? (
            <div className="row">
              <a className="button primary" href={`./api/report?short=${short}`} target="_blank" rel="noopener">
                Open the report
              </a>
              <a className="button" href={`./api/report?download=true&short=${short}`} download="health.html">
                Download
              </a>
              <button disabled={printing} onClick={() => void print()}>
                {printing ? "Printing…" : "Download as PDF"}
              </button>
              <Check label="short" value={short} set={setShort} />
            </div>
          ) : (
            <p className="state warn">The design is not complete: there is nothing to report yet.</p>
          )}
        </section>
        <section className="card">
          <h2>The design file</h2>
          <p>
            {design.file} is a text file. Opening another one replaces the design on this page; that can be undone, and {design.file} itself changes only when you save.
          </p>
          <div className="row">
            <a className="button" href="./api/design/download" download={design.file}>
              Download the design
            </a>
            <OnlyFor role="editor">
              <FileButton label="Open a design file" accept=".yaml,.yml" take={(one) => void one.text().then((text) => replaceText(text, `Open ${one.name}`)).then((done) => done && go("design")).catch(sayError)} />
            </OnlyFor>
            <button onClick={() => void get("/api/library/schema").then((schema) => offer("robot.schema.json", "application/json", JSON.stringify(schema, null, 1))).catch(sayError)}>JSON Schema</button>
          </div>
        </section>
        <section className="card">
          <h2>Parts lists</h2>
          <p>.csv, .xlsx and .ods as KiCad, Altium and offices export them; looked at first, column by column.</p>
          <button onClick={() => go("parts", "import")}>Import a parts list…</button>
        </section>
        <section className="card">
          <h2>Measurements for others</h2>
          <p>
            Prometheus reads <code>/metrics</code>; a dashboard for Grafana comes along.
          </p>
          <div className="row">
            <a className="button" href="./metrics" target="_blank" rel="noopener">
              Metrics
            </a>
            <a className="button" href="./api/grafana" download="robophm-grafana.json">
              Grafana dashboard
            </a>
          </div>
        </section>
        <section className="card">
          <h2>A file of the 2020 tool</h2>
          <p>phm_configurations_*.yaml becomes a design; what is odd in it is said before anything is changed.</p>
          <OnlyFor role="editor">
            <FileButton label="Choose a file" accept=".yaml,.yml" take={look} />
          </OnlyFor>
          {wrong && (
            <div className="trouble" role="alert">
              {wrong}
            </div>
          )}
          {legacy && (
            <>
              <h3>{legacy.name}</h3>
              {legacy.found.findings.map((one) => (
                <p key={one} className="small">
                  {one}
                </p>
              ))}
              <Preview label="What the file says" columns={legacy.found.columns} rows={legacy.found.rows} />
              <button className="primary" onClick={() => void replaceText(legacy.found.text, `Import ${legacy.name}`).then((done) => done && go("design"))}>
                Use as the design
              </button>
            </>
          )}
        </section>
      </div>
      <Recordings />
    </>
  );
}
