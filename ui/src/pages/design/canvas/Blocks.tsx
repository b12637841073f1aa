import { Background, Controls, type Edge, type Node, type NodeProps, type NodeTypes, ReactFlow, useReactFlow, useStore } from "@xyflow/react";
import { type ReactNode, useEffect, useMemo, useRef, useState } from "react";
import { get, type Shapes } from "../../../lib/api";
import { useDesign, useShared, useUnit } from "../../../lib/store";
import { findPart, levelOf, type Part } from "../../../lib/tree";
import { Icon } from "../../../parts/Icon";
import { rateText } from "../../../lib/words";
import { move } from "../moving";
import { colouring, Legend, markOf, useCondition, useConditions, Value } from "./condition";
import { type Drag, dropped, stem, targetAt } from "./dragging";
import { MANY, TilesView, type TilesNode } from "./Tiles";

type Box = Shapes["Box"];
type BoxNode = Node<{ box: Box; chosen: boolean; mark: string; open: (path: string) => void }, "box">;
type GateNode = Node<{ gate: Shapes["Gate"]; mark: string }, "gate">;
type WiresNode = Node<{ drawing: Shapes["Drawing"] }, "wires">;

const NO_EDGES: Edge[] = [];
const GATE = 34;
const FAR = 0.5; // zoomed out beyond this, values are too small to be read, and names stand larger
const FARTHER = 0.35; // and of many boxes so are names: each is a tile

function BoxView({ data }: NodeProps<BoxNode>): ReactNode {
  const { box } = data;
  const unit = useUnit();
  const colour = useShared(colouring);
  const condition = useCondition(box.part ? stem(box.part) : "");
  const flags = colour === "health" ? (condition?.flags ?? []) : [];
  return (
    <div
      className={`box ${box.kind} ${data.chosen ? "chosen" : ""} ${box.spare ? "spare" : ""} ${box.wrong?.length ? "wrong" : markOf(condition, colour)} ${data.mark}`}
      style={{ width: box.width, height: box.height }}
      onDoubleClick={() => box.kind === "module" && box.part && data.open(box.part)}
      title={[box.part, ...(box.wrong?.length ? box.wrong : [box.detail]), ...flags, box.places > 1 && `drawn in ${box.places} places, one part`, box.single_point && "its failure alone fails the robot"].filter(Boolean).join("\n")}
    >
      <span className="title">
        {box.title}
        {box.places > 1 && <span className="badge">one part</span>}
      </span>
      <span className="detail">
        {box.wrong?.length ? (
          <span className="mistake">
            <Icon name="error" /> {box.detail}
          </span>
        ) : (
          <span className="value">
            <Value condition={condition} colour={colour} plain={box.detail} rate={(rate) => rateText(rate, unit)} />
          </span>
        )}
        <span>{box.badge}</span>
      </span>
      {box.single_point && box.kind === "component" && (
        <span className="single" title="single point of failure">
          <Icon name="warn" />
        </span>
      )}
    </div>
  );
}

function GateView({ data }: NodeProps<GateNode>): ReactNode {
  return (
    <div className={`gate ${data.mark}`} style={{ width: data.gate.width, height: GATE }}>
      {data.gate.text}
    </div>
  );
}

function WiresView({ data }: NodeProps<WiresNode>): ReactNode {
  const { width, height, wires, ends } = data.drawing;
  const path = (dashed: boolean): string =>
    wires
      .filter((one) => one.dashed === dashed)
      .map((one) => `M${one.points.map(([x, y]) => `${x} ${y}`).join("L")}`)
      .join("");
  return (
    <svg width={width} height={height} className="wires" aria-hidden="true">
      <path d={path(false)} />
      <path d={path(true)} strokeDasharray="5 5" />
      {ends.map(([x, y], i) => (
        <circle key={i} cx={x} cy={y} r={4} />
      ))}
    </svg>
  );
}

/** What is wrong in the design of the level itself, and of others: what is in a box is said there. */
function Mistakes({ drawing }: { drawing: Shapes["Drawing"] }): ReactNode {
  const { wrong = [], wired, elsewhere = 0 } = drawing;
  const empty = !drawing.boxes.length;
  if (!wrong.length && !elsewhere && wired !== false) return null;
  return (
    <div className="trouble small" role="status">
      {wrong.map((one) => (
        <p key={one}>{one}</p>
      ))}
      {wired === false && <p>How these parts work together is not known until the diagram is mended: they are drawn without wires.</p>}
      {empty && <p>Add a component, or a module, and it is drawn here.</p>}
      {elsewhere > 0 && <p className="quiet">{elsewhere === 1 ? "One mistake" : `${elsewhere} mistakes`} in other levels: see Design at the top.</p>}
    </div>
  );
}

const TYPES: NodeTypes = { box: BoxView, gate: GateView, wires: WiresView, tiles: TilesView };

interface Props {
  level: string;
  chosen: string[];
  choose: (paths: string[]) => void;
  open: (level: string) => void;
}

/** A level's block diagram as the service lays it out. Boxes are dragged elsewhere, or to another level. */
export function Blocks({ level, chosen, choose, open }: Props): ReactNode {
  const design = useDesign();
  const unit = useUnit();
  const flow = useReactFlow();
  const [drawing, setDrawing] = useState<Shapes["Drawing"] | null>(null);
  const [drawn, setDrawn] = useState(""); // what the drawing is of
  const [fitted, setFitted] = useState<Shapes["Drawing"] | null>(null);
  const [wrong, setWrong] = useState("");
  const [whole, setWhole] = useState(false);
  const [around, setAround] = useState(""); // a part in the stretch that is drawn, of a level with too many to be drawn at once
  const host = useRef<HTMLDivElement>(null);
  const [width, setWidth] = useState(0);
  const [drag, setDrag] = useState<Drag | null>(null);
  const far = useStore((state) => state.transform[2] < FAR);
  const farther = useStore((state) => state.transform[2] < FARTHER);
  const tiled = farther && !!drawing && drawing.boxes.length > MANY;
  useConditions(level, whole);

  useEffect(() => {
    if (!host.current) return;
    const observer = new ResizeObserver(([entry]) => setWidth(Math.max(450, Math.round((entry?.contentRect.width ?? 1000) / 50) * 50 - 50)));
    observer.observe(host.current);
    return () => observer.disconnect();
  }, []);

  const wanted = JSON.stringify([level, unit, whole, width, design?.state, around]);
  const busy = !wrong && (drawn !== wanted || fitted !== drawing);
  useEffect(() => {
    const asked = new AbortController();
    if (!width) return;
    get("/api/design/drawing", { path: level, width: whole ? Math.max(width, 1200) : width, unit, whole, around }, asked.signal)
      .then((found) => {
        setDrawing(found);
        setDrawn(wanted);
        setWrong("");
      })
      .catch((error: unknown) => {
        const why = error instanceof Error ? error.message : String(error);
        if (!asked.signal.aborted) setWrong(design?.valid ? why : `There is nothing to draw until this is mended: ${why}`);
      });
    return () => asked.abort();
  }, [wanted]);

  useEffect(() => {
    if (!drawing) return;
    const same = drawing.path === fitted?.path && drawing.earlier === fitted.earlier && drawing.width === fitted.width && drawing.height === fitted.height;
    if (same) setFitted(drawing); // seen as the user left it
    else requestAnimationFrame(() => void flow.fitView({ padding: 0.06, maxZoom: 1.15 }).then(() => setFitted(drawing)));
  }, [drawing, flow]);

  const alone = chosen.length === 1 ? chosen[0]! : "";
  const absent = !!alone && drawing?.path === level && !!(drawing.earlier || drawing.later) && (whole ? alone.startsWith(level && `${level}/`) : levelOf(alone) === level) && !drawing.boxes.some((box) => box.part && `${stem(box.part)}/`.startsWith(`${alone}/`));
  useEffect(() => {
    if (absent) setAround(alone);
  }, [absent, alone]);

  // a part of many that was found elsewhere, as in the tree, is gone to
  const sought = chosen.length === 1 && drawing && drawing.boxes.length > MANY ? drawing.boxes.find((box) => box.part && stem(box.part) === chosen[0]) : undefined;
  useEffect(() => {
    if (!sought || fitted !== drawing || !host.current) return;
    const { x, y, zoom } = flow.getViewport();
    const [left, top] = [sought.x * zoom + x, sought.y * zoom + y];
    if (zoom < FAR || left < 0 || top < 0 || left + sought.width * zoom > host.current.clientWidth || top + sought.height * zoom > host.current.clientHeight)
      void flow.setCenter(sought.x + sought.width / 2, sought.y + sought.height / 2, { zoom: 1 });
  }, [chosen, sought?.part, fitted]);

  const laid = useMemo<Node[]>(() => {
    if (!drawing) return [];
    const common = { draggable: false, connectable: false, deletable: false };
    const found: Node[] = [
      { ...common, id: "wires", type: "wires", position: { x: 0, y: 0 }, width: drawing.width, height: drawing.height, data: { drawing }, selectable: false, focusable: false, zIndex: 0, style: { pointerEvents: "none" } },
    ];
    if (tiled) {
      const data: TilesNode["data"] = { boxes: drawing.boxes, width: drawing.width, level, chosen, choose: (path) => choose([path]) };
      found.push({ ...common, id: "tiles", type: "tiles", position: { x: 0, y: 0 }, width: drawing.width, height: drawing.height, data, selectable: false, focusable: false, zIndex: 1 });
      return found;
    }
    drawing.boxes.forEach((box, i) =>
      found.push({
        ...common,
        id: `box ${i}`,
        type: "box",
        position: { x: box.x, y: box.y },
        width: box.width,
        height: box.height,
        data: { box, chosen: !!box.part && chosen.includes(stem(box.part)), open, mark: "" },
        draggable: !busy && !!box.part && !whole && levelOf(stem(box.part)) === level,
        selectable: !!box.part,
        focusable: !!box.part,
        ariaLabel: [box.title, ...(box.wrong?.length ? box.wrong : [box.detail]), box.badge, box.single_point ? "single point of failure" : ""].filter(Boolean).join(", "),
        zIndex: 1,
      }),
    );
    drawing.gates.forEach((gate, i) =>
      found.push({ ...common, id: `gate ${i}`, type: "gate", position: { x: gate.x, y: gate.y - GATE / 2 }, width: gate.width, height: GATE, data: { gate, mark: "" }, selectable: false, focusable: false, zIndex: 1 }),
    );
    return found;
  }, [drawing, chosen, choose, open, level, whole, busy, tiled]);
  // those out of sight are never measured, and nothing could be fitted into view
  const nodes = useMemo(() => laid.map((one) => ({ ...one, measured: { width: one.width, height: one.height } })), [laid]);

  const shown = useMemo(() => {
    if (!drag) return nodes;
    return nodes.map((node) => {
      if (node.id === drag.id) return { ...node, position: drag.at, zIndex: 5, data: { ...node.data, mark: "dragged" } };
      return node.id === drag.target?.id ? { ...node, data: { ...node.data, mark: `target ${drag.target.how}` } } : node;
    });
  }, [nodes, drag]);

  /** What is dragged: all that is chosen where that is of this level, else the one. */
  function taken(id: string): Part[] {
    const box = (nodes.find((node) => node.id === id)?.data as { box?: Box } | undefined)?.box;
    const path = box?.part ? stem(box.part) : "";
    const several = chosen.includes(path) && chosen.every((one) => levelOf(one) === level) ? chosen : [path];
    return design ? several.map((one) => findPart(design, one)).filter((one): one is Part => !!one?.path) : [];
  }

  function pick(path: string, add: boolean): void {
    choose(!add ? [path] : chosen.includes(path) ? chosen.filter((one) => one !== path) : [...chosen.filter(Boolean), path]);
  }

  function step(part: string | null | undefined): void {
    choose([level]); // else what is chosen would be gone to
    setAround(part ?? "");
  }

  function keys(event: React.KeyboardEvent): void {
    const id = (event.target as HTMLElement).closest(".react-flow__node")?.getAttribute("data-id");
    const box = (nodes.find((node) => node.id === id)?.data as { box?: Box } | undefined)?.box;
    if (!box?.part || (event.key !== "Enter" && event.key !== " ")) return;
    const path = stem(box.part);
    if (event.key === "Enter" && box.kind === "module" && chosen.includes(path)) open(path);
    else pick(path, event.key === " ");
    event.preventDefault();
  }

  return (
    <div className={`canvas ${far ? "far" : ""}`} ref={host} onKeyDown={keys} aria-busy={busy}>
      {!wrong && drawing && <Mistakes drawing={drawing} />}
      {wrong ? (
        <div className="empty" role="status">
          <p>{wrong}</p>
        </div>
      ) : (
        <ReactFlow
          nodes={shown}
          edges={NO_EDGES}
          nodeTypes={TYPES}
          minZoom={0.05}
          maxZoom={3}
          nodesConnectable={false}
          selectionOnDrag={false}
          selectNodesOnDrag={false}
          disableKeyboardA11y
          deleteKeyCode={null}
          panActivationKeyCode={null}
          onlyRenderVisibleElements={nodes.length > 200}
          proOptions={{ hideAttribution: true }}
          onNodeClick={(event, node) => {
            const part = (node.data as { box?: Box }).box?.part;
            if (part) pick(stem(part), event.ctrlKey || event.metaKey || event.shiftKey);
          }}
          onNodesChange={(changes) => {
            for (const one of changes) if (one.type === "position" && one.dragging && one.position) setDrag({ id: one.id, at: one.position, target: drag?.target ?? null });
          }}
          onNodeDrag={(event, node) => {
            const target = targetAt(event, flow.screenToFlowPosition, drawing, level, taken(node.id));
            setDrag((old) => old && { ...old, target });
          }}
          onNodeDragStop={(event, node) => {
            const parts = taken(node.id);
            const target = targetAt(event, flow.screenToFlowPosition, drawing, level, parts);
            setDrag(null);
            if (target) void dropped(target, parts, level, move).then((paths) => paths && choose(paths));
          }}
          onSelectionEnd={() => {
            const picked = flow.getNodes().filter((node) => node.selected).map((node) => (node.data as { box?: Box }).box?.part).filter((one): one is string => !!one);
            if (picked.length) choose([...new Set(picked.map(stem))]);
          }}
          onPaneClick={() => choose([level])}
        >
          <Background gap={22} size={1} color="var(--edge)" />
          <Controls showInteractive={false} />
        </ReactFlow>
      )}
      <div className="below small quiet">
        <label className="check" style={{ margin: 0 }}>
          <input type="checkbox" checked={whole} onChange={(event) => setWhole(event.target.checked)} /> down to the parts
        </label>
        <Legend />
        {drag ? (
          <strong aria-live="polite">{drag.target ? `Drop it here: ${drag.target.words}` : "Drop it here: nothing changes"}</strong>
        ) : (
          <span className="hint-line">▲ single point of failure. Double-click a module to open it; drag a box to move it (M); Shift+drag or Ctrl+click chooses several.</span>
        )}
        {drawing && (drawing.earlier || drawing.later) && (
          <span className="row">
            <button disabled={!drawing.earlier} onClick={() => step(drawing.earlier)}>
              Earlier parts
            </button>
            <button disabled={!drawing.later} onClick={() => step(drawing.later)}>
              Later parts
            </button>
          </span>
        )}
        {!drag && drawing?.notes.map((note) => <span key={note}>{note}</span>)}
      </div>
    </div>
  );
}
