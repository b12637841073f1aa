import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes, upload } from "../../lib/api";
import { useDesign } from "../../lib/store";
import { Check, FileButton, Text } from "../../parts/Field";
import { Found, hoursOf, messageOf, Trouble } from "./Found";

/** FMEA of the design, and of a table of sensors: what sees what, and what alarms mean. */
export function FailureModes(): ReactNode {
  const design = useDesign();
  const [hours, setHours] = useState("1000");
  const [found, setFound] = useState<Shapes["FoundTables"] | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    const ends = new AbortController();
    setFound(null);
    get("/api/analysis/fmea", { hours: hoursOf(hours) }, ends.signal)
      .then((one) => {
        setFound(one);
        setWrong("");
      })
      .catch((error: unknown) => ends.signal.aborted || setWrong(messageOf(error)));
    return () => ends.abort();
  }, [design?.state, hours]);
  return (
    <div className="stack">
      <div className="fields">
        <Text label="Within [h of operation]" inputMode="decimal" value={hours} set={setHours} />
      </div>
      <Trouble>{wrong}</Trouble>
      {found ? <Found found={found} /> : !wrong && <p className="quiet">Computing…</p>}
      <Diagnosis />
    </div>
  );
}

function Diagnosis(): ReactNode {
  const design = useDesign();
  const [file, setFile] = useState<File | null>(null);
  const [on, setOn] = useState<string[]>([]);
  const [asked, setAsked] = useState(false);
  const [found, setFound] = useState<Shapes["FoundTables"] | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    if (!file) return;
    let wanted = true;
    upload("/api/analysis/diagnosis", file, { name: file.name, alarms: on, quiet: asked && !on.length })
      .then((one) => {
        if (!wanted) return;
        setFound(one);
        setWrong("");
      })
      .catch((error: unknown) => wanted && setWrong(messageOf(error)));
    return () => {
      wanted = false;
    };
  }, [file, on, asked, design?.state]);
  return (
    <>
      <section className="card" aria-label="Diagnosis">
        <h2>Diagnosis</h2>
        <div className="row">
          <FileButton label={file ? `Replace ${file.name}` : "Choose a table of sensors"} accept=".csv,.yaml,.yml" take={(one) => { setFile(one); setOn([]); setAsked(false); setFound(null); }} />
          <span className="small quiet">Columns: sensor, part, detects, false alarm, price, fitted. Nothing is changed.</span>
        </div>
        {found && found.sensors.length > 0 && (
          <fieldset className="row" style={{ marginTop: 8 }}>
            <legend className="small">Alarms that are on; all others are off</legend>
            {found.sensors.map((one) => (
              <Check key={one} label={one} value={on.includes(one)} set={(is) => setOn(is ? [...on, one] : on.filter((name) => name !== one))} />
            ))}
            <Check label="none is on" value={asked && !on.length} set={(is) => { setAsked(is); setOn([]); }} />
          </fieldset>
        )}
      </section>
      <Trouble>{wrong}</Trouble>
      {found && <Found found={found} />}
    </>
  );
}
