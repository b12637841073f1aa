import { type ReactNode, useEffect, useState } from "react";
import { file as fetched, get, type Shapes, upload } from "../../lib/api";
import { offer } from "../../lib/exports";
import { sayError, useDesign } from "../../lib/store";
import { moreText } from "../../lib/words";
import { FileButton, Select, Text } from "../../parts/Field";
import { Found, hoursOf, messageOf, Trouble, wrongHours } from "./Found";

type Tree = Shapes["FoundTree"];

/** The fault tree of the design as it is new, and one of another tool. */
export function FaultTree(): ReactNode {
  const design = useDesign();
  const [hours, setHours] = useState("1000");
  const [of, setOf] = useState("");
  const [found, setFound] = useState<Tree | null>(null);
  const [wrong, setWrong] = useState("");
  const functions = Object.keys((design?.document.functions as object | undefined) ?? {});
  const asked = { hours: hoursOf(hours), function: of && functions.includes(of) ? of : undefined };
  useEffect(() => {
    if (wrongHours(hours)) return;
    const ends = new AbortController();
    get("/api/analysis/fault-tree", asked, ends.signal)
      .then((one) => {
        setFound(one);
        setWrong("");
      })
      .catch((error: unknown) => ends.signal.aborted || setWrong(messageOf(error)));
    return () => ends.abort();
  }, [design?.state, hours, asked.function]);
  return (
    <div className="stack">
      <div className="fields">
        <Text label="After [h of operation of a new robot]" wrong={wrongHours(hours)} inputMode="decimal" value={hours} set={setHours} />
        {functions.length > 0 && <Select label="Top event: failure of" value={asked.function ?? ""} set={setOf} options={[["", "the whole robot"], ...functions.map((one) => [one, one] as const)]} />}
      </div>
      <Trouble>{wrong}</Trouble>
      {found ? (
        <Answer found={found} label="Fault tree of the design">
          <button onClick={() => void fetched("/api/analysis/fault-tree.xml", asked).then((xml) => offer("fault-tree.xml", "application/xml", xml)).catch(sayError)}>Download as Open-PSA model</button>
        </Answer>
      ) : !wrong && <p className="quiet">Computing…</p>}
      <OfFile />
    </div>
  );
}

function OfFile(): ReactNode {
  const [file, setFile] = useState<File | null>(null);
  const [hours, setHours] = useState("");
  const [top, setTop] = useState("");
  const [tops, setTops] = useState<string[]>([]);
  const [found, setFound] = useState<Tree | null>(null);
  const [wrong, setWrong] = useState("");
  const time = hoursOf(hours);
  useEffect(() => {
    if (!file || wrongHours(hours)) return;
    let wanted = true;
    upload("/api/analysis/fault-tree-of-file", file, { name: file.name, hours: time, top: top || undefined })
      .then((one) => {
        if (!wanted) return;
        setFound(one);
        if (!top) setTops(one.tops);
        setWrong("");
      })
      .catch((error: unknown) => wanted && setWrong(messageOf(error)));
    return () => {
      wanted = false;
    };
  }, [file, hours, top]);
  function take(one: File): void {
    setFile(one);
    setTop("");
    setTops([]);
    setFound(null);
    setWrong("");
  }
  return (
    <>
      <section className="card" aria-label="A fault tree of another tool">
        <h2>A fault tree of another tool</h2>
        <div className="row">
          <FileButton label={file ? `Replace ${file.name}` : "Choose a fault tree"} accept=".xml,.dft" take={take} />
          <span className="small quiet">An Open-PSA model (.xml), or a dynamic fault tree in the Galileo format (.dft). Nothing is changed.</span>
        </div>
        {file && (
          <div className="fields" style={{ marginTop: 8 }}>
            <Text label="Mission time [h]" hint={file.name.endsWith(".dft") ? "the time by which its top event occurs" : "empty: as the model gives it"} wrong={wrongHours(hours)} inputMode="decimal" value={hours} set={setHours} />
            {tops.length > 0 && <Select label="Of these" value={top} set={setTop} options={[["", `all ${tops.length}`], ...tops.map((one) => [one, one] as const)]} />}
          </div>
        )}
      </section>
      <Trouble>{wrong}</Trouble>
      {found ? <Answer found={found} label={`Fault tree of ${file?.name}`} /> : file && !wrong && <p className="quiet">Computing…</p>}
    </>
  );
}

const DEEPEST = 10;

function Answer({ found, label, children }: { found: Tree; label: string; children?: ReactNode }): ReactNode {
  return (
    <>
      <section className="card">
        <p>
          <strong>{found.says}</strong>
        </p>
        {found.tree.length > 0 && (
          <ul className="gates scroll" tabIndex={0} aria-label={label}>
            {found.tree.map((one, i) => (
              <li key={i} style={{ marginInlineStart: 18 * Math.min(one.depth, DEEPEST) }}>
                <span className="hidden">level {one.depth + 1}: </span>
                {one.chance ? one.text : <strong>{one.text}</strong>}
                <span className="quiet">{one.chance}</span>
              </li>
            ))}
          </ul>
        )}
        {children && <p>{children}</p>}
        {found.more > 0 && <p className="small quiet">{moreText(found.more)}.</p>}
      </section>
      <Found found={found} />
    </>
  );
}
