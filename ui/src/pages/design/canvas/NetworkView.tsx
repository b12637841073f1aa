import {
  Background, BaseEdge, ConnectionMode, Controls, type Edge, EdgeLabelRenderer, type EdgeProps, type EdgeTypes, Handle, MarkerType,
  type Node, type NodeProps, type NodeTypes, Position, ReactFlow, useReactFlow,
} from "@xyflow/react";
import { type ReactNode, useEffect, useMemo, useState } from "react";
import { course, HIGH, type Join, joinsOf, layout, type Network, nodesOf, type Point, WIDE, withLink, withNode, withOther, withoutLink, withoutNode } from "../../../lib/network";
import { editWithUndo, say, useDesign, useUnit } from "../../../lib/store";
import { isValues, type Part } from "../../../lib/tree";
import { marked, rateText } from "../../../lib/words";
import { Asking } from "../../../parts/Dialog";
import { Select, Text } from "../../../parts/Field";
import { OnlyFor } from "../../../parts/OnlyFor";

type Kind = "part" | "junction" | "end";
type PlaceNode = Node<{ name: string; kind: Kind; detail: string; chosen: boolean }, "place">;
type LinkEdge = Edge<{ path: string; middle: Point; words: string; chosen: boolean }, "link">;

const HANDLES = [["in", Position.Left], ["out", Position.Right]] as const;

function PlaceView({ data }: NodeProps<PlaceNode>): ReactNode {
  return (
    <div className={`box ${data.kind} ${data.chosen ? "chosen" : ""}`} style={{ width: WIDE, height: HIGH }} title={data.kind === "junction" ? "a junction, which cannot fail" : undefined}>
      <span className="title">{data.name}</span>
      <span className="detail">{data.detail}</span>
      {HANDLES.map(([id, at]) => (
        <Handle key={id} id={id} type="source" position={at} title="Drag to another node: a link" />
      ))}
    </div>
  );
}

function LinkView({ id, data, markerEnd }: EdgeProps<LinkEdge>): ReactNode {
  if (!data) return null;
  return (
    <>
      <BaseEdge id={id} path={data.path} markerEnd={markerEnd} interactionWidth={26} className={data.chosen ? "chosen" : ""} />
      {data.words && (
        <EdgeLabelRenderer>
          <span className="through" style={{ transform: `translate(-50%, -50%) translate(${data.middle.x}px, ${data.middle.y}px)` }}>
            {data.words}
          </span>
        </EdgeLabelRenderer>
      )}
    </>
  );
}

const NODES: NodeTypes = { place: PlaceView };
const EDGES: EdgeTypes = { link: LinkView };

const idOf = (join: Join): string => `${join.link} ${join.step}`;
const wordsOf = (join: Join): string => `${join.start} ${join.oneWay ? "→" : "–"} ${join.end}`;

interface Props {
  level: Part;
  place: string[];
  network: Network;
  chosen: string[];
  choose: (paths: string[]) => void;
}

/** A network as nodes and links, edited: whatever is drawn can be done by the lists below it too. */
export function NetworkView({ level, place, network, chosen, choose }: Props): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const flow = useReactFlow();
  const [link, setLink] = useState("");
  const [dialog, setDialog] = useState<"" | "link" | "node">("");
  const names = useMemo(() => nodesOf(network), [network]);
  const joins = useMemo(() => joinsOf(network), [network]);
  const parts = useMemo(() => new Map(level.parts.map((one) => [one.name, one])), [level]);
  const partOf = (name: string): Part | undefined => parts.get(name.replace(/\[\d+\]$/, ""));

  const put = (value: Network, what: string): void => {
    setLink("");
    void editWithUndo([{ op: "put", path: [...level.place, ...place], value }], what);
  };
  const connect = (start: string, end: string): void => {
    if (start === end) say("A link joins two nodes.", "error");
    else if (joins.some((one) => !one.oneWay && one.through == null && [one.start, one.end].includes(start) && [one.start, one.end].includes(end))) say(`${start} and ${end} are joined already.`);
    else put(withLink(network, start, end), `Linked ${start} and ${end}`);
  };

  const at = useMemo(() => layout(network), [network]);
  const [fitted, setFitted] = useState(0); // how many nodes are seen whole
  useEffect(() => {
    requestAnimationFrame(() => void flow.fitView({ padding: 0.12, maxZoom: 1.15 }).then(() => setFitted(names.length)));
  }, [names.length, flow]);

  const nodes = useMemo<PlaceNode[]>(
    () =>
      names.map((name) => {
        const part = parts.get(name.replace(/\[\d+\]$/, ""));
        const kind: Kind = part ? "part" : name === network.from || name === network.to ? "end" : "junction";
        const role = name === network.from ? "begins here" : name === network.to ? "ends here" : "";
        const detail = part ? [marked(design?.unknown[part.path], "hazard_rate", rateText(design?.levels[part.path]?.hazard_rate, unit)), role].filter(Boolean).join(" · ") : role || "junction";
        const { x, y } = at.get(name)!;
        return {
          id: name, type: "place", position: { x: x - WIDE / 2, y: y - HIGH / 2 }, width: WIDE, height: HIGH,
          data: { name, kind, detail, chosen: !!part && chosen.includes(part.path) },
          draggable: false, deletable: false, ariaLabel: `${name}, ${detail}`,
        };
      }),
    [names, parts, at, design, unit, network, chosen],
  );
  const edges = useMemo<LinkEdge[]>(() => {
    const twins = new Map<string, number>();
    return joins.map((join) => {
      const pair = [join.start, join.end].sort().join("\n");
      const twin = twins.get(pair) ?? 0;
      twins.set(pair, twin + 1);
      const others = names.filter((name) => name !== join.start && name !== join.end).map((name) => at.get(name)!);
      const words = join.through == null ? "" : typeof join.through === "string" ? join.through : "parts";
      return {
        id: idOf(join), type: "link", source: join.start, target: join.end, sourceHandle: "out", targetHandle: "in", ariaLabel: wordsOf(join),
        data: { ...course(at.get(join.start)!, at.get(join.end)!, others, twin), words, chosen: idOf(join) === link },
        markerEnd: join.oneWay ? { type: MarkerType.ArrowClosed, width: 22, height: 22, color: "var(--line)" } : undefined,
      };
    });
  }, [joins, names, at, link]);

  function keys(event: React.KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const edge = target.closest(".react-flow__edge")?.getAttribute("data-id");
    const node = target.closest(".react-flow__node")?.getAttribute("data-id");
    if (edge && (event.key === "Enter" || event.key === " ")) setLink(edge);
    else if (edge && event.key === "Delete") remove(edge);
    else if (node && (event.key === "Enter" || event.key === " ")) pick(node);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
  function remove(id: string): void {
    const join = joins.find((one) => idOf(one) === id);
    if (join) put(withoutLink(network, join), `Removed the link ${wordsOf(join)}`);
  }
  function pick(name: string): void {
    const part = partOf(name);
    if (part) choose([part.path]);
  }

  return (
    <div className="canvas" onKeyDown={keys} aria-busy={fitted !== names.length}>
      <ReactFlow
        nodes={nodes}
        edges={edges}
        nodeTypes={NODES}
        edgeTypes={EDGES}
        connectionMode={ConnectionMode.Loose}
        connectionRadius={90}
        minZoom={0.05}
        maxZoom={3}
        disableKeyboardA11y
        deleteKeyCode={null}
        panActivationKeyCode={null}
        proOptions={{ hideAttribution: true }}
        onConnect={({ source, target }) => connect(source, target)}
        onEdgeClick={(_, edge) => setLink(edge.id)}
        onNodeClick={(_, node) => pick(node.id)}
        onPaneClick={() => {
          setLink("");
          choose([level.path]);
        }}
      >
        <Background gap={22} size={1} color="var(--edge)" />
        <Controls showInteractive={false} />
      </ReactFlow>
      <div className="below small">
        <OnlyFor role="editor">
          <button onClick={() => setDialog("link")}>Add a link…</button>
          <button onClick={() => setDialog("node")}>Add a node…</button>
        </OnlyFor>
        <span className="quiet hint-line">Drag from a dot to another node: a link. It works while a path of working parts leads from {network.from} to {network.to}.</span>
      </div>
      <details className="links small" open={!!link || undefined}>
        <summary>
          {joins.length} links, {names.length} nodes
        </summary>
        <OnlyFor role="editor">
          <ul aria-label="Links">
            {joins.map((join) => (
              <li key={idOf(join)} className={idOf(join) === link ? "chosen" : ""}>
                <span>{wordsOf(join)}</span>
                <button onClick={() => put(withOther(network, join, { oneWay: !join.oneWay }), `${wordsOf(join)} ${join.oneWay ? "both ways" : "one way"}`)}>{join.oneWay ? "Both ways" : "One way"}</button>
                {join.oneWay && <button onClick={() => put(withOther(network, join, { start: join.end, end: join.start }), `Turned ${wordsOf(join)}`)}>Turn</button>}
                {isValues(join.through) ? (
                  <span className="quiet">through parts, as text</span>
                ) : (
                  <select
                    aria-label={`What on ${wordsOf(join)} may fail`}
                    value={typeof join.through === "string" ? join.through : ""}
                    onChange={(event) => put(withOther(network, join, { through: event.target.value || undefined }), `What on ${wordsOf(join)} may fail`)}
                  >
                    <option value="">nothing on it fails</option>
                    {level.parts.filter((one) => one.name === join.through || !names.includes(one.name)).map((one) => (
                      <option key={one.name} value={one.name}>
                        through {one.name}
                      </option>
                    ))}
                  </select>
                )}
                <button className="icon" aria-label={`Remove the link ${wordsOf(join)}`} title="Remove" onClick={() => remove(idOf(join))}>
                  ×
                </button>
              </li>
            ))}
          </ul>
          <ul aria-label="Nodes">
            {names.filter((name) => name !== network.from && name !== network.to).map((name) => (
              <li key={name}>
                <span>{name}</span>
                <button aria-label={`Take ${name} out of the network`} onClick={() => put(withoutNode(network, name), `Took ${name} out of the network`)}>
                  Remove
                </button>
              </li>
            ))}
          </ul>
        </OnlyFor>
      </details>
      {dialog === "link" && <LinkDialog names={names} close={() => setDialog("")} done={connect} />}
      {dialog === "node" && (
        <NodeDialog
          names={names}
          parts={level.parts.filter((one) => !names.includes(one.name))}
          close={() => setDialog("")}
          done={(name, junction, start, end) => put(withNode(network, name, junction, start, end), `Put ${name} between ${start} and ${end}`)}
        />
      )}
    </div>
  );
}

function Ends({ names, start, end, set }: { names: string[]; start: string; end: string; set: (start: string, end: string) => void }): ReactNode {
  const options = names.map((one): [string, string] => [one, one]);
  return (
    <>
      <Select label="From" value={start} set={(one) => set(one, end)} options={options} />
      <Select label="To" value={end} set={(one) => set(start, one)} options={options} />
    </>
  );
}

function LinkDialog({ names, close, done }: { names: string[]; close: () => void; done: (start: string, end: string) => void }): ReactNode {
  const [[start, end], setEnds] = useState<[string, string]>([names[0]!, names[names.length - 1]!]);
  return (
    <Asking title="Add a link" verb="Link them" close={close} wrong={start === end} done={() => done(start, end)}>
      <Ends names={names} start={start} end={end} set={(one, other) => setEnds([one, other])} />
    </Asking>
  );
}

function NodeDialog({ names, parts, close, done }: { names: string[]; parts: Part[]; close: () => void; done: (name: string, junction: boolean, start: string, end: string) => void }): ReactNode {
  const [[start, end], setEnds] = useState<[string, string]>([names[0]!, names[names.length - 1]!]);
  const [part, setPart] = useState(parts[0]?.name ?? "");
  const [name, setName] = useState("");
  const said = name.trim();
  const taken = !part && (names.includes(said) || parts.some((one) => one.name === said)) ? "a name of its own" : "";
  return (
    <Asking title="Add a node" verb="Put it there" close={close} wrong={start === end || (!part && (!said || !!taken))} done={() => done(part || said, !part, start, end)}>
      <Select label="What" value={part} set={setPart} options={[...parts.map((one): [string, string] => [one.name, one.name]), ["", "a junction, which cannot fail"]]} />
      {!part && <Text label="Name of the junction" value={name} set={setName} wrong={taken} />}
      <Ends names={names} start={start} end={end} set={(one, other) => setEnds([one, other])} />
    </Asking>
  );
}
