import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes, upload } from "../../lib/api";
import { useDesign, useUnit } from "../../lib/store";
import { FileButton, Text } from "../../parts/Field";
import { Found, hoursOf, messageOf, Trouble } from "./Found";

/** A requirement with its margin, and another design beside this one. */
export function Compare(): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const [percent, setPercent] = useState("90");
  const [hours, setHours] = useState("1000");
  const [file, setFile] = useState<File | null>(null);
  const [margin, setMargin] = useState<Shapes["Margin"] | null>(null);
  const [found, setFound] = useState<Shapes["FoundTables"] | null>(null);
  const [wrong, setWrong] = useState("");
  const wanted = Number(percent.replace(",", ".")) / 100;
  const reliability = wanted > 0 && wanted < 1 ? wanted : undefined;
  useEffect(() => {
    const ends = new AbortController();
    const fail = (error: unknown): void => void (ends.signal.aborted || setWrong(messageOf(error)));
    setWrong("");
    get("/api/analysis/requirement", { reliability, hours: hoursOf(hours) }, ends.signal).then(setMargin).catch(fail);
    if (file)
      upload("/api/analysis/compared", file, { name: file.name, reliability, hours: hoursOf(hours), unit })
        .then((one) => ends.signal.aborted || setFound(one))
        .catch(fail);
    return () => ends.abort();
  }, [design?.state, reliability, hours, file, unit]);
  return (
    <div className="stack">
      <section className="card" aria-label="Requirement">
        <h2>Requirement</h2>
        <div className="fields">
          <Text label="Reliability [%]" inputMode="decimal" value={percent} set={setPercent} wrong={reliability ? undefined : "Above 0 and below 100"} />
          <Text label="through [h of operation of a new robot]" inputMode="decimal" value={hours} set={setHours} wrong={hoursOf(hours) ? undefined : "A number of hours"} />
        </div>
        {margin && reliability && <p className={margin.met ? "" : "state error"}>{margin.says}.</p>}
      </section>
      <section className="card" aria-label="Another design">
        <h2>Another design beside this one</h2>
        <div className="row">
          <FileButton label={file ? `Replace ${file.name}` : "Choose a design"} accept=".yaml,.yml" take={(one) => { setFound(null); setFile(one); }} />
          <span className="small quiet">A design file, .yaml. Nothing is changed.</span>
        </div>
      </section>
      <Trouble>{wrong}</Trouble>
      {found && <Found found={found} />}
    </div>
  );
}
