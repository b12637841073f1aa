import { type ReactNode, useEffect, useId, useState } from "react";
import { get, type Shapes } from "../../lib/api";
import { useShared } from "../../lib/store";
import { FileButton, Select } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Plot } from "../../parts/Plot";
import { Found, messageOf, Trouble } from "../analysis/Found";
import { going, handed, handIn, refused } from "../new/state";

/** What the recordings hold that were handed in, or named when the service was started. */
export function Recordings(): ReactNode {
  const received = useShared(handed);
  const now = useShared(going);
  const notTaken = useShared(refused);
  const [names, setNames] = useState<string[]>([]);
  const [chosen, setChosen] = useState("");
  const [found, setFound] = useState<Shapes["RecordedTopics"] | null>(null);
  const [wrong, setWrong] = useState("");
  const name = names.includes(chosen) ? chosen : "";
  useEffect(() => void get("/api/recordings").then((one) => setNames(one.names), (error: unknown) => setWrong(messageOf(error))), [received]);
  useEffect(() => {
    setFound(null);
    if (!name) return;
    const ends = new AbortController();
    setWrong("");
    get("/api/recordings/topics", { name }, ends.signal).then(setFound, (error: unknown) => ends.signal.aborted || setWrong(messageOf(error)));
    return () => ends.abort();
  }, [name]);
  return (
    <div className="stack" style={{ marginTop: 16 }}>
      <section className="card" aria-label="Recordings">
        <h2>Recordings</h2>
        <p className="small quiet">What was recorded: topics with their rates and gaps, fields with their units, and the course of any of them. Up to 500 MB each; robophm data reads larger ones.</p>
        <div className="row" style={{ alignItems: "end" }}>
          {names.length > 0 && <Select label="Recording" value={name} set={setChosen} options={[["", "choose one"], ...names.map((one) => [one, one] as const)]} />}
          <OnlyFor role="editor">
            <div className="field">
              <FileButton label="Hand in recordings" several={handIn} />
            </div>
          </OnlyFor>
        </div>
        {now && <p role="status">{`${now.name}: ${Math.round(100 * now.share)} %`}</p>}
        {!names.length && !wrong && <p className="quiet">None is here yet: hand one in, or name it when you start robophm serve (--replay).</p>}
      </section>
      {notTaken.map((one) => (
        <Trouble key={one}>{one}</Trouble>
      ))}
      <Trouble>{wrong}</Trouble>
      {name && !found && !wrong && <p className="quiet">Reading {name}…</p>}
      {found && (
        <>
          {found.signals.length > 0 && <Course key={name} name={name} signals={found.signals} />}
          <Found found={found} />
        </>
      )}
    </div>
  );
}

function Course({ name, signals }: { name: string; signals: string[] }): ReactNode {
  const [signal, setSignal] = useState(signals[0]!);
  const [found, setFound] = useState<Shapes["RecordedSignal"] | null>(null);
  const [wrong, setWrong] = useState("");
  const [id, list] = [useId(), useId()];
  useEffect(() => {
    const ends = new AbortController();
    get("/api/recordings/signal", { name, signal }, ends.signal)
      .then((one) => {
        setFound(one);
        setWrong("");
      })
      .catch((error: unknown) => ends.signal.aborted || setWrong(messageOf(error)));
    return () => ends.abort();
  }, [name, signal]);
  return (
    <section aria-label="Course of a signal">
      <div className="field">
        <label htmlFor={id}>Signal</label>
        <input id={id} list={list} key={signal} defaultValue={signal} aria-describedby={`${id}-hint`} onChange={(event) => signals.includes(event.target.value) && setSignal(event.target.value)} onBlur={(event) => event.target.value.trim() && setSignal(event.target.value.trim())} onKeyDown={(event) => event.key === "Enter" && setSignal(event.currentTarget.value.trim() || signal)} />
        <datalist id={list}>
          {signals.map((one) => (
            <option key={one} value={one} />
          ))}
        </datalist>
        <span className="hint" id={`${id}-hint`}>
          /topic.field, of an array with [2] or [name]
        </span>
      </div>
      <Trouble>{wrong}</Trouble>
      {found && (
        <Plot
          title="Course"
          xLabel="time"
          yLabel={found.label}
          time
          curves={[
            { name: "lowest", x: found.times, y: found.lowest, color: 2 },
            { name: "highest", x: found.times, y: found.highest, color: 3 },
          ]}
          empty="No samples."
        >
          <span className="small quiet">{[found.says, ...found.notes].join("; ")}</span>
        </Plot>
      )}
    </section>
  );
}
