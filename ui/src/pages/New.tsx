import { type ReactNode, useEffect, useState } from "react";
import { useRefusal, visitor } from "../lib/access";
import { get, post, Refused, type Shapes } from "../lib/api";
import { pulse } from "../lib/live";
import { go, replaceText, runExample, say, sayError, useDesign, useDraft, useShared } from "../lib/store";
import { Entry, FileButton, Select } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { Table } from "../parts/Table";
import { Files } from "./new/Files";
import { Proposed } from "./new/Proposed";
import { change, handed, load, said } from "./new/state";

export const page = { name: "New robot", icon: ICONS.add, order: 85 };

export default function New(): ReactNode {
  const known = useShared(visitor) !== null;
  const refusal = useRefusal("editor");
  if (!known) return <p className="quiet">Loading…</p>;
  if (!refusal) return <Begin />;
  return (
    <>
      <div className="head">
        <h1>New robot</h1>
      </div>
      <p>{refusal}.</p>
    </>
  );
}

function Begin(): ReactNode {
  const design = useDesign();
  const found = useShared(handed);
  const { draft, wrong, busy } = useDrafted();
  useEffect(() => void load(), [design?.state]);
  if (!design || !found) return <p className="quiet">Loading…</p>;
  return (
    <div className="stack">
      <div>
        <div className="head">
          <h1>{found.becomes === "new" ? "No robot yet" : "New robot"}</h1>
          {busy && <span className="quiet small" role="status">Drafting…</span>}
        </div>
        <p>From what you have to its health: a draft with ranges, which says what it assumes. Nothing is changed before you use it.</p>
        {found.becomes === "replacement" && <p className="trouble">{design.name} is here already, and was not drafted: a draft takes its place. Undo brings it back.</p>}
        {found.becomes === "update" && <p className="quiet">{design.name} is of a draft: a later one changes only what nobody has touched.</p>}
      </div>
      {found.becomes === "new" && <Otherwise />}
      <Files />
      {draft && <Questions asked={draft.questions} says={[...draft.says, ...draft.doubts]} />}
      {(wrong || draft?.refused) && (
        <div className="trouble" role="alert">
          {wrong || draft?.refused}
        </div>
      )}
      {draft && <Proposed parts={draft.parts} />}
      {draft && <Sensors draft={draft} recorded={draft.says.length > 0} />}
      {draft && !draft.refused && <Use draft={draft} />}
    </div>
  );
}

/** The draft of what is said and handed in now: asked for again whenever that changes. */
function useDrafted(): { draft: Shapes["Drafted"] | null; wrong: string; busy: boolean } {
  const now = useShared(said);
  const found = useShared(handed);
  const [draft, setDraft] = useState<Shapes["Drafted"] | null>(null);
  const [wrong, setWrong] = useState("");
  const [busy, setBusy] = useState(false);
  const files = found && JSON.stringify(found.files);
  useEffect(() => {
    if (files === null) return;
    let over = false;
    setBusy(true);
    post("/api/new/draft", now)
      .then((drafted) => {
        if (over) return;
        setDraft(drafted);
        setWrong("");
      })
      .catch((error: unknown) => !over && setWrong(error instanceof Refused ? error.message : String(error)))
      .finally(() => !over && setBusy(false));
    return () => void (over = true);
  }, [now, files]);
  return { draft, wrong, busy };
}

function Questions({ asked, says }: { asked: Shapes["DraftQuestion"][]; says: string[] }): ReactNode {
  const { answers } = useShared(said);
  return (
    <section className="card">
      <h2>2. What no file tells</h2>
      {says.map((one) => (
        <p key={one}>{one}</p>
      ))}
      <p className="small quiet">Whatever you leave empty is assumed as it says below, and noted in assumptions.md.</p>
      <div className="fields wide">
        {asked.map((one) => (
          <Entry
            key={one.key}
            label={one.text}
            value={answers[one.key] ?? ""}
            placeholder={one.default}
            hint={`Assumed: ${one.default ? `${one.default} (${one.because})` : one.because}`}
            wrong={one.wrong}
            set={(text) => {
              const { [one.key]: _, ...rest } = answers;
              change({ answers: text.trim() ? { ...rest, [one.key]: text.trim() } : rest });
            }}
          />
        ))}
      </div>
    </section>
  );
}

function Sensors({ draft, recorded }: { draft: Shapes["Drafted"]; recorded: boolean }): ReactNode {
  return (
    <section className="card">
      <h2>4. What its sensors tell of them</h2>
      {draft.bound.length > 0 ? (
        <Table label="Bound signals" columns={["Part", "Input", "Signal", "Seen"]}>
          {draft.bound.map((one) => (
            <tr key={`${one.part} ${one.input}`}>
              <th scope="row">{one.part || "the robot"}</th>
              <td>{one.input}</td>
              <td>{one.signals.join(", ")}</td>
              <td className="small">
                {one.seen}
                {one.assumed && <span className="quiet">; assumed: {one.assumed}</span>}
              </td>
            </tr>
          ))}
        </Table>
      ) : (
        <p>{recorded ? "No recorded signal goes with a part by its name." : "Without a recording no signal is known."} Signals can be bound later, on the page Sensors, from topics of the running robot too.</p>
      )}
      {draft.unbound.length > 0 && (
        <details>
          <summary>{draft.unbound.length} not bound, and why</summary>
          {draft.unbound.map((one) => (
            <p key={one} className="small">
              {one}
            </p>
          ))}
        </details>
      )}
      {draft.tasks.length > 0 && <p className="small quiet">Tasks seen: {draft.tasks.join("; ")}.</p>}
    </section>
  );
}

const PACE = 10;

/** The draft becomes the design, and is watched. */
function Use({ draft }: { draft: Shapes["Drafted"] }): ReactNode {
  const now = useShared(said);
  const found = useShared(handed);
  const { monitoring } = useShared(pulse);
  const [sources, setSources] = useState<Shapes["SourceChoice"][]>([]);
  const [source, setSource] = useState("");
  const [busy, setBusy] = useState(false);
  const files = JSON.stringify(found?.files);
  const watches = draft.bound.length > 0 && monitoring !== "running";
  useEffect(() => {
    void get("/api/monitoring")
      .then((state) => {
        setSources(state.sources);
        setSource((old) => old || (state.sources[0]?.paced ? state.sources[0].name : ""));
      })
      .catch(sayError);
  }, [files]);

  async function use(): Promise<void> {
    setBusy(true);
    if (await useDraft(now, `draft ${draft.name}`)) {
      say(`${draft.name} is saved; beside it lie assumptions.md and the tasks that were seen`);
      try {
        const paced = sources.find((one) => one.name === source)?.paced;
        if (watches && source) await post("/api/monitoring/start", { source, speed: paced ? PACE : 1 });
      } catch (error) {
        sayError(error);
      }
      go("overview");
    }
    setBusy(false);
  }

  return (
    <section className="card">
      <h2>5. Use it</h2>
      <div className="fields">
        <Entry label="Name of the robot" value={now.name || draft.name} set={(name) => change({ name: name.trim() })} />
        {watches && (
          <Select
            label="And then"
            value={source}
            set={setSource}
            options={[...sources.map((one): [string, string] => [one.name, one.paced ? `replay ${one.label}, ${PACE}× as fast` : `watch it live: ${one.label}`]), ["", "nothing yet"]]}
          />
        )}
      </div>
      <button className="primary" disabled={busy} onClick={() => void use()}>
        Use this robot
      </button>
    </section>
  );
}

/** Other ways to begin. */
function Otherwise(): ReactNode {
  const [examples, setExamples] = useState<Shapes["Example"][]>([]);
  useEffect(() => void get("/api/examples").then((all) => setExamples(all.examples)).catch(sayError), []);
  const open = async (name: string): Promise<void> => {
    try {
      const { text } = await get("/api/examples/{name}", { name });
      if (await replaceText(text, `open the example ${name}`)) go("overview");
    } catch (error) {
      sayError(error);
    }
  };
  const openFile = async (file: File): Promise<void> => {
    if (await replaceText(await file.text(), `open ${file.name}`)) go("overview");
  };
  return (
    <section className="card">
      <div className="row">
        <button className="primary" onClick={() => void runExample().then((done) => done && go("overview"))}>
          Watch an example robot drive
        </button>
        <FileButton label="Open a design file" accept=".yaml,.yml" take={(file) => void openFile(file).catch(sayError)} />
        <button onClick={() => go("design")}>Draw it by hand</button>
        <button onClick={() => go("reports", "legacy")}>Import a file of the 2020 tool</button>
      </div>
      <details>
        <summary>Example designs</summary>
        <div className="row">
          {examples.map((one) => (
            <button key={one.name} onClick={() => void open(one.name)}>
              {one.title}
            </button>
          ))}
        </div>
      </details>
    </section>
  );
}
