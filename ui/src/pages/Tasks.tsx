import { type ReactNode, useEffect, useState } from "react";
import { get, post, type Shapes } from "../lib/api";
import { pulse } from "../lib/live";
import { say, sayError, useDesign, useShared } from "../lib/store";
import { chanceWords, durationText, marked, momentText, numberText, oddsText, percentText, shareText, type Unknown } from "../lib/words";
import { FileButton, Text } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { Table } from "../parts/Table";
import { Watching } from "../parts/Watching";
import { Prognosis } from "./tasks/Prognosis";

export const page = { name: "Tasks", icon: ICONS.task, order: 70 };

type Task = Shapes["SaidTask"];

/** Tasks of a list that is predicted without being asked to. */
const AT_ONCE = 20;

export default function Tasks(): ReactNode {
  const design = useDesign();
  const { looks } = useShared(pulse);
  const [list, setList] = useState<Task[]>([]);
  const [answer, setAnswer] = useState<Shapes["Answer"] | null>(null);
  const [arrived, setArrived] = useState<Shapes["ArrivedTask"][]>([]);
  const [wrong, setWrong] = useState("");
  const beat = Math.floor(looks / 4);

  useEffect(() => void get("/api/tasks/arrived").then((found) => setArrived(found.tasks)).catch(() => undefined), [beat]);
  useEffect(() => {
    if (!list.length && design?.valid)
      get("/api/tasks/design")
        .then((found) => setList((now) => (now.length ? now : found.tasks.map((one) => ({ ...one, name: one.name || "the design's task" })))))
        .catch(() => undefined);
    // only when a design comes
  }, [design?.valid]);

  async function ask(tasks: Task[], still: () => boolean = () => true): Promise<void> {
    try {
      const found = await post("/api/tasks/predict", { tasks, failed: [], working: [], future: "recent" });
      if (still()) setAnswer(found);
      if (still()) setWrong("");
    } catch (error) {
      if (!still()) return;
      setAnswer(null);
      setWrong(error instanceof Error ? error.message : String(error));
    }
  }
  useEffect(() => {
    setAnswer(null);
    setWrong("");
    if (!list.length || list.length > AT_ONCE || !design?.valid) return;
    let current = true;
    void ask(list, () => current);
    return () => void (current = false);
  }, [list, design?.state, design?.valid]);

  async function read(file: File): Promise<void> {
    try {
      const format = file.name.toLowerCase().endsWith(".csv") ? "csv" : "yaml";
      const found = await post("/api/tasks/read", { format, text: await file.text() });
      setList(found.tasks);
      say(`${found.tasks.length} tasks from ${file.name}`);
    } catch (error) {
      sayError(error);
    }
  }

  const add = (task: Task): void => setList((now) => [...now, task]);
  if (!design) return null;
  const leftOut = new Set(arrived.flatMap((one) => [one.predicted?.unknown?.sentence ?? [], one.actual?.unknown?.sentence ?? []].flat()));
  return (
    <>
      <div className="head">
        <h1>Tasks</h1>
        <span className="grow" />
        <Watching />
      </div>
      {!design.valid && <div className="trouble">The design is not complete yet; mend its problems first.</div>}
      <div className="two">
        <section className="card">
          <h2>Can I do this?</h2>
          <NewTask functions={Object.keys((design.document.functions as object | undefined) ?? {})} add={add}>
            <FileButton label="Tasks from a file…" accept=".yaml,.yml,.csv" take={(file) => void read(file)} />
            <button type="button" onClick={() => setList([])} disabled={!list.length}>
              Clear the list
            </button>
          </NewTask>
          <ol>
            {list.slice(0, 50).map((task, i) => (
              <li key={i}>
                {task.name || `task ${i + 1}`} <span className="small quiet">{legWords(task)}</span>{" "}
                <button className="plain" aria-label={`Remove ${task.name || `task ${i + 1}`}`} onClick={() => setList(list.filter((_, n) => n !== i))}>
                  ×
                </button>
              </li>
            ))}
          </ol>
          {list.length > 50 && <p className="small quiet">and {list.length - 50} more</p>}
          {!list.length && <p className="quiet">The list is empty: add a task, or take one that arrived.</p>}
          <button className={list.length > AT_ONCE ? "primary" : ""} disabled={!list.length || !design.valid} onClick={() => void ask(list)}>
            {answer ? "Predict again, as of now" : "Predict"}
          </button>
          {wrong && (
            <div className="trouble" role="alert" style={{ marginTop: 10 }}>
              {wrong}
            </div>
          )}
          {answer && <Answered answer={answer} />}
        </section>
        <Prognosis tasks={list} ready={design.valid && list.length > 0} />
      </div>
      <section className="card" style={{ marginTop: 16 }}>
        <h2>Tasks that the robot told of</h2>
        {!arrived.length && <p className="quiet">None yet. They stand here as they come, while watching runs.</p>}
        {[...leftOut].map((one) => (
          <p key={one} className="small">{one}.</p>
        ))}
        {arrived.length > 0 && <ArrivedTable tasks={arrived} add={add} />}
      </section>
    </>
  );
}

function legWords(task: Task): string {
  const one = task.legs[0];
  if (!one) return "";
  const parts = [short(one.distance, "m"), one.speed, short(one.duration, "h")].filter(Boolean).join(", ");
  return task.legs.length > 1 ? `${task.legs.length} legs, the first: ${parts}` : parts;
}

/** "0.23148148148148148 h" is "13.9 min". */
function short(said: string | null | undefined, unit: string): string {
  const number = Number.parseFloat(said ?? "");
  if (!said || !said.endsWith(` ${unit}`) || !Number.isFinite(number)) return said ?? "";
  return unit === "h" ? durationText(number) : `${numberText(number)} ${unit}`;
}

function NewTask({ functions, add, children }: { functions: string[]; add: (task: Task) => void; children: ReactNode }): ReactNode {
  const [distance, setDistance] = useState("250 m");
  const [speed, setSpeed] = useState("0.3 m/s");
  const [duration, setDuration] = useState("");
  const [name, setName] = useState("");
  const [needs, setNeeds] = useState("");
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        const leg = { distance: distance || null, speed: duration ? null : speed || null, duration: duration || null, functions: needs ? needs.split(",").map((one) => one.trim()) : [], stresses: {} };
        add({ name, legs: [leg] });
      }}
    >
      <div className="fields narrow">
        <Text label="Name" value={name} set={setName} />
        <Text label="Distance" value={distance} set={setDistance} />
        <Text label="Speed" value={speed} set={setSpeed} />
        <Text label="or duration" hint="e.g. 20 min" value={duration} set={setDuration} />
        {functions.length > 0 && <Text label="Needs" hint={`of ${functions.join(", ")}; empty: the whole robot`} value={needs} set={setNeeds} />}
      </div>
      <div className="row" style={{ marginBottom: 8 }}>
        <button type="submit">Add to the list</button>
        {children}
      </div>
    </form>
  );
}

/** A probability, and below it the odds of failing. */
function Chance({ of, unknown }: { of: Shapes["Chance"]; unknown: Unknown }): ReactNode {
  const odds = oddsText(of.failure);
  return (
    <>
      {marked(unknown, "ahead", percentText(of.probability, of.failure))}
      {odds && <div className="small quiet">fails {odds}</div>}
    </>
  );
}

function Answered({ answer }: { answer: Shapes["Answer"] }): ReactNode {
  return (
    <div style={{ marginTop: 12 }} aria-live="polite">
      {answer.unknown && <p className="small">{answer.unknown.sentence}.</p>}
      {answer.breached && <p className="state error">Less likely than the design wants: {percentText(answer.threshold)}</p>}
      <Table label="Answer" className="scroll stacked" columns={["Task", ["Distance", "number"], ["Time", "number"], ["PoTC nominal", "number"], ["PoTC sensor-based", "number"]]}>
        {answer.tasks.slice(0, 50).map((one, i) => (
          <tr key={i}>
            <th scope="row">{one.name || `task ${i + 1}`}</th>
            <td className="number" data-label="Distance">{numberText(one.distance)} m</td>
            <td className="number" data-label="Time">{durationText(one.duration)}</td>
            <td className="number" data-label="PoTC nominal"><Chance of={one.chance.nominal} unknown={answer.unknown} /></td>
            <td className="number" data-label="PoTC sensor-based"><Chance of={one.chance.sensor_based} unknown={answer.unknown} /></td>
          </tr>
        ))}
        {answer.tasks.length > 1 && (
          <tr>
            <th scope="row">all of them</th>
            <td className="number" data-label="Distance">{numberText(answer.distance)} m</td>
            <td className="number" data-label="Time">{durationText(answer.duration)}</td>
            <td className="number" data-label="PoTC nominal"><Chance of={answer.together.nominal} unknown={answer.unknown} /></td>
            <td className="number" data-label="PoTC sensor-based"><Chance of={answer.together.sensor_based} unknown={answer.unknown} /></td>
          </tr>
        )}
      </Table>
      {answer.wear.map((one) => (
        <p key={one.mode} className={one.critical ? "small state warn" : "small"}>
          Seen to wear: {one.mode}: {one.says}
        </p>
      ))}
      <p className="small quiet">
        Decided by (share of the failures that would vanish):{" "}
        {answer.deciding.slice(0, 5).map((one) => `${one.path} ${shareText(one.share)}`).join(", ")}
      </p>
    </div>
  );
}

function ArrivedTable({ tasks, add }: { tasks: Shapes["ArrivedTask"][]; add: (task: Task) => void }): ReactNode {
  const both = (driven: Shapes["TaskFigures"] | null): ReactNode =>
    driven?.chance ? (
      <>
        {chanceWords(driven.chance.sensor_based, driven.unknown)}
        <br />
        <span className="small quiet">nominal {chanceWords(driven.chance.nominal, driven.unknown)}</span>
      </>
    ) : (
      "–"
    );
  return (
    <Table
      label="Arrived tasks"
      columns={["Arrived", ["Predicted way and time", "number"], ["Predicted PoTC", "number"], ["Actual way and time", "number"], ["Actual PoTC", "number"], ["Add", "spoken"]]}
    >
      {tasks.slice(0, 100).map((one, i) => (
        <tr key={i}>
          <th scope="row" className="moment">{momentText(one.arrived ?? one.start)}</th>
          <td className="number">{one.predicted ? `${numberText(one.predicted.distance)} m, ${durationText(one.predicted.duration)}` : "–"}</td>
          <td className="number">{both(one.predicted)}</td>
          <td className="number">{one.actual ? `${numberText(one.actual.distance)} m, ${durationText(one.actual.duration)}` : one.end == null ? "under way" : "–"}</td>
          <td className="number">{both(one.actual)}</td>
          <td>
            <button
              aria-label="Add to the list"
              title="Add to the list"
              disabled={!one.predicted}
              onClick={() => {
                const planned = one.predicted!;
                add({ name: `as of ${momentText(one.arrived ?? one.start)}`, legs: [{ distance: `${planned.distance} m`, duration: `${planned.duration} h`, functions: [], stresses: {} }] });
                say("Added to the list for prognostic analysis");
              }}
            >
              Add
            </button>
          </td>
        </tr>
      ))}
    </Table>
  );
}
