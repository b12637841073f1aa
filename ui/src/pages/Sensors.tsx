import { type ReactNode, useCallback, useEffect, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { useHealth } from "../lib/health";
import { editWithUndo, route, sayError, useDesign, useShared } from "../lib/store";
import { everyPart, isValues, treeOf } from "../lib/tree";
import { numberText, secondsText, unitText } from "../lib/words";
import { ICONS } from "../parts/Icon";
import { OnlyFor } from "../parts/OnlyFor";
import { Table } from "../parts/Table";
import { Watching } from "../parts/Watching";
import { BindForm, type Start } from "./sensors/BindForm";

export const page = { name: "Sensors", icon: ICONS.sensor, order: 60 };

interface Binding {
  at: string;
  place: string[];
  kind: string;
  words: string;
  signals: string[];
}

export default function Sensors(): ReactNode {
  const design = useDesign();
  const { health } = useHealth();
  const { rest } = useShared(route);
  const [sources, setSources] = useState<Shapes["SourceChoice"][]>([]);
  const [source, setSource] = useState("");
  const [topics, setTopics] = useState<Shapes["Topics"] | null>(null);
  const [wrong, setWrong] = useState("");
  const [text, setText] = useState("");
  const [start, setStart] = useState<Start>({ level: rest });

  const look = useCallback(async (name: string): Promise<void> => {
    setSource(name);
    setTopics(null);
    try {
      setTopics(await get("/api/topics", { source: name }));
      setWrong("");
    } catch (error) {
      setWrong(error instanceof Error ? error.message : String(error));
    }
  }, []);

  useEffect(() => {
    get("/api/monitoring")
      .then((state) => {
        setSources(state.sources);
        const first = state.sources.find((one) => one.paced) ?? state.sources[0];
        if (first) void look(first.name);
      })
      .catch(sayError);
  }, [look]);

  if (!design) return null;
  const bindings: Binding[] = [...everyPart(treeOf(design))].flatMap((part) => [
    ...Object.entries(isValues(part.values.signals) ? part.values.signals : {}).map(([input, one]): Binding => {
      const said = isValues(one) ? one : {};
      const range = Array.isArray(said.range) ? `, ${said.range.join(" to ")}` : "";
      return {
        at: part.path, place: [...part.place, "signals", input], kind: input,
        words: `${String(said.topic)}.${String(said.field)} [${String(said.unit ?? "unit of the input")}]${range}; holds ${String(said.max_age ?? "5 s")}, then ${String(said.stale ?? "conservative")}`,
        signals: [`${String(said.topic)}.${String(said.field)}`],
      };
    }),
    ...Object.entries(isValues(part.values.clocks) ? part.values.clocks : {}).map(([clock, one]): Binding => {
      const said = isValues(one) ? one : {};
      const fields = Array.isArray(said.position) ? said.position.map(String) : [String(said.speed ?? said.edge ?? "")];
      return { at: part.path, place: [...part.place, "clocks", clock], kind: `${clock} (clock)`, words: `${String(said.topic)}: ${fields.join(", ")}`, signals: fields.map((one) => `${String(said.topic)}.${one}`) };
    }),
  ]);
  const words = text.toLowerCase();
  const shown = topics?.topics.filter((one) => one.topic.toLowerCase().includes(words) || one.type.toLowerCase().includes(words)) ?? [];
  return (
    <>
      <div className="head">
        <h1>Sensors</h1>
        <span className="grow" />
        <Watching />
      </div>
      <div className="split">
        <section className="card">
          <h2>Topics</h2>
          <div className="row" style={{ marginBottom: 8 }}>
            <select aria-label="Source of topics" value={source} onChange={(event) => void look(event.target.value)}>
              {sources.map((one) => (
                <option key={one.name} value={one.name}>
                  {one.label}
                </option>
              ))}
            </select>
            <input type="search" aria-label="Find a topic" placeholder="Find a topic or type" value={text} onChange={(event) => setText(event.target.value)} />
            <button onClick={() => void look(source)}>Refresh</button>
          </div>
          {wrong && (
            <div className="trouble" role="alert">
              {wrong}
            </div>
          )}
          {!wrong && !topics && <p className="quiet">Looking…</p>}
          {topics && !shown.length && <p>No topic{words ? " of that name" : " yet: nothing is published"}.</p>}
          {shown.map((one) => (
            <details key={one.topic} open={shown.length < 4}>
              <summary>
                <strong>{one.topic}</strong> <span className="small quiet">{one.type} {one.rate != null && `· ${numberText(one.rate, 3)} per second`} {one.messages > 0 && `· ${one.messages.toLocaleString("en-US")} messages`}</span>
              </summary>
              <div className="fieldlist">
                {one.fields.map((field) => (
                  <button key={field.field} onClick={() => setStart({ level: start.level, topic: one.topic, field: field.field, unit: field.unit ?? "" })} title="Bind this field">
                    {field.field}
                    {field.unit ? ` [${field.unit}]` : ""}
                    {field.last != null && <span className="quiet"> {numberText(field.last)}</span>}
                  </button>
                ))}
                {!one.fields.length && <p className="small quiet">No numbers in it, or nobody tells its definition.</p>}
              </div>
            </details>
          ))}
        </section>
        <section className="card">
          <h2>Bind a field</h2>
          <BindForm key={`${start.topic ?? ""} ${start.field ?? ""} ${start.level}`} start={start} />
        </section>
      </div>
      <section className="card" style={{ marginTop: 16 }}>
        <h2>Bound</h2>
        {!bindings.length && <p>Nothing is bound: sensor-based figures are the nominal ones. Choose a field above.</p>}
        {bindings.length > 0 && (
          <Table label="Bound signals" columns={["Of", "Drives", "Signal", ["Last value", "number"], "Heard", ["Unbind", "spoken"]]}>
            {bindings.map((one) => {
              const heard = health?.sensors.find((sensor) => one.signals.includes(sensor.signal));
              return (
                <tr key={one.place.join("/")}>
                  <th scope="row">{one.at || design.name}</th>
                  <td>{one.kind}</td>
                  <td>{one.words}</td>
                  <td className="number">{heard?.value == null ? "–" : `${numberText(heard.value)} ${unitText(heard.unit)}`}</td>
                  <td>{health?.monitoring === "idle" ? "not watching" : heard?.stale ? <span className="state stale">STALE, {secondsText(heard.age)}</span> : secondsText(heard?.age)}</td>
                  <td>
                    <OnlyFor role="editor">
                      <button aria-label={`Unbind ${one.kind} of ${one.at || design.name}`} onClick={() => void editWithUndo([{ op: "delete", path: one.place }], `Unbound ${one.kind} of ${one.at || design.name}`)}>
                        Unbind
                      </button>
                    </OnlyFor>
                  </td>
                </tr>
              );
            })}
          </Table>
        )}
      </section>
    </>
  );
}
