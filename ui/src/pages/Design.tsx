import { lazy, type ReactNode, Suspense, useCallback, useEffect, useMemo, useState } from "react";
import { editWithUndo, edit, go, route, say, useDesign, useShared } from "../lib/store";
import type { Operation } from "../lib/api";
import { findPart, freeName, levelOf, levelPlace, type Part, treeOf } from "../lib/tree";
import { lastStep } from "../lib/words";
import { ICONS } from "../parts/Icon";
import { Canvas } from "./design/Canvas";
import { GroupDialog } from "./design/GroupDialog";
import { Inspector } from "./design/Inspector";
import { MoveDialog } from "./design/MoveDialog";
import { RenameDialog } from "./design/RenameDialog";
import { unapplied } from "./design/text/unapplied";
import { Tree } from "./design/Tree";
import "./design/design.css";
import { OnlyFor } from "../parts/OnlyFor";

const TextEditor = lazy(() => import("./design/text/TextEditor"));

export const page = { name: "Design", icon: ICONS.diagram, order: 20, flush: true };

/** Tree, canvas, inspector. What is chosen in one is chosen in all; "" is the robot. */
export default function Design(): ReactNode {
  const design = useDesign();
  const { rest } = useShared(route);
  const [chosen, setChosen] = useState<string[]>([rest]);
  const [level, setLevel] = useState("");
  const [dialog, setDialog] = useState<"" | "group" | "rename" | "move">("");
  const [asText, setAsText] = useState(false);
  const tree = useMemo(() => design && treeOf(design), [design]);

  const choose = useCallback((paths: string[]) => setChosen(paths.length ? paths : [""]), []);

  const known = design !== null;
  useEffect(() => {
    if (design && unapplied(design.history)) setAsText(true);
    // when the page is opened
  }, [known]);
  useEffect(() => {
    setChosen([rest]);
    const part = design ? findPart(design, rest) : undefined;
    if (part) setLevel(part.kind === "component" ? levelOf(part.path) : part.path);
    // when somebody goes to a part, not whenever the design changes
  }, [rest, known]);

  const first = chosen[0] ?? "";
  const part = design ? findPart(design, first) : undefined;
  const gone = design !== null && !part && first !== rest; // undone, moved or deleted by somebody else: what it was in is shown
  useEffect(() => {
    if (!gone || !design) return;
    let above = levelOf(first);
    while (above && !findPart(design, above)) above = levelOf(above);
    choose([above]);
  }, [gone, first, design, choose]);
  const shownLevel = design && findPart(design, level)?.kind !== "component" && findPart(design, level) ? level : "";

  if (!design || !tree) return null;

  const parts = chosen.map((path) => findPart(design, path)).filter((one): one is Part => !!one && !!one.path);

  function remove(): void {
    if (!parts.length) return;
    const doomed = parts.filter((one) => !parts.some((other) => one.path.startsWith(`${other.path}/`)));
    const operations: Operation[] = doomed.map((one) => ({ op: "delete", path: one.place }));
    void editWithUndo(operations, `Deleted ${doomed.length === 1 ? doomed[0]!.name : `${doomed.length} parts`}`);
    choose([levelOf(doomed[0]!.path)]);
  }

  async function add(kind: "module" | "component", under: Part): Promise<void> {
    const host = under.kind === "component" ? findPart(design!, levelOf(under.path))! : under;
    const name = freeName(host, kind === "module" ? "New module" : "New component");
    const value = kind === "module" ? {} : { rate: "unknown" }; // nobody has said it yet
    const path = host.path ? `${host.path}/${name}` : name;
    if (await edit([{ op: "put", path: [...host.place, `${kind}s`, name], value }], `Add ${name}`)) {
      setLevel(host.path);
      choose([path]);
      setDialog("rename");
    }
  }

  function startGroup(): void {
    const levels = new Set(parts.map((one) => levelOf(one.path)));
    if (parts.length < 2) say("Choose at least two parts first: Ctrl+click, or Space in the tree.");
    else if (levels.size > 1) say("These parts are of different levels; a group is of parts of one level.", "error");
    else setDialog("group");
  }

  function startMove(): void {
    if (!parts.length) say("Choose a part first.");
    else if (new Set(parts.map((one) => levelOf(one.path))).size > 1) say("These parts are of different levels; move those of one level.", "error");
    else setDialog("move");
  }

  function moved(paths: string[]): void {
    choose(paths);
    setLevel(levelOf(paths[0]!));
  }

  function keys(event: React.KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (/^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName) || target.closest("dialog")) return;
    if (event.key === "Delete") remove();
    else if (event.key === "F2" && parts.length === 1) setDialog("rename");
    else if (event.ctrlKey && event.key.toLowerCase() === "g") startGroup();
    else if (!event.ctrlKey && event.key.toLowerCase() === "m") startMove();
    else return;
    event.preventDefault();
  }

  return (
    <div className={asText ? "design as-text" : "design"} onKeyDown={keys}>
      <section className="side" aria-label="Parts of the robot">
        <h1 className="hidden">Design</h1>
        <div className="row tools">
          <OnlyFor role="editor">
            <button onClick={() => part && void add("module", part)}>Add module</button>
            <button onClick={() => part && void add("component", part)}>Add component</button>
          </OnlyFor>
        </div>
        <Tree
          root={tree}
          chosen={chosen}
          choose={choose}
          open={(one) => {
            setLevel(one.kind === "component" ? levelOf(one.path) : one.path);
            choose([one.path]);
          }}
          design={design}
        />
      </section>
      <section className="drawing" aria-label="Block diagram">
        <div className="row tools">
          <Crumbs level={shownLevel} robot={design.name} show={setLevel} />
          <span className="grow" />
          <OnlyFor role="editor">
            <button onClick={startGroup} disabled={parts.length < 2} title="Ctrl+G">
              Group…
            </button>
            <button
              disabled={!parts.length}
              onClick={() => void edit([{ op: "ungroup", path: levelPlace(shownLevel), members: parts.map((one) => one.name) }], "Ungroup")}
            >
              Ungroup
            </button>
            <button disabled={!parts.length} onClick={startMove} title="M, or drag a box">
              Move…
            </button>
            <button disabled={parts.length !== 1} onClick={() => setDialog("rename")} title="F2">
              Rename
            </button>
            <button disabled={!parts.length} onClick={remove} title="Delete">
              Delete
            </button>
          </OnlyFor>
        </div>
        <Canvas level={shownLevel} chosen={chosen} choose={choose} open={setLevel} />
      </section>
      {asText ? (
        <section className="side right" aria-label="The design as text">
          <Suspense fallback={<p className="quiet">Loading the editor…</p>}>
            <TextEditor place={part?.place ?? []} close={() => setAsText(false)} />
          </Suspense>
        </section>
      ) : (
        <section className="side right" aria-label="Inspector">
          {part ? (
            <Inspector key={part.path} part={part} several={parts.length} design={design} editText={() => setAsText(true)} />
          ) : gone ? null : (
            <div className="trouble">
              There is no part {first}. <button onClick={() => go("design")}>To the robot</button>
            </div>
          )}
        </section>
      )}
      {dialog === "group" && <GroupDialog members={parts} level={levelOf(parts[0]!.path)} close={() => setDialog("")} />}
      {dialog === "move" && parts.length > 0 && <MoveDialog parts={parts} close={() => setDialog("")} moved={moved} />}
      {dialog === "rename" && parts[0] && (
        <RenameDialog
          part={parts[0]}
          close={() => setDialog("")}
          done={(name) => {
            const level = levelOf(parts[0]!.path);
            choose([level ? `${level}/${name}` : name]);
          }}
        />
      )}
    </div>
  );
}

function Crumbs({ level, robot, show }: { level: string; robot: string; show: (level: string) => void }): ReactNode {
  const steps = level ? level.split("/") : [];
  return (
    <nav aria-label="Level" className="row">
      {["", ...steps.map((_, i) => steps.slice(0, i + 1).join("/"))].map((path, i, all) => (
        <span key={path} className="row">
          {i > 0 && <span aria-hidden="true">›</span>}
          {i === all.length - 1 ? (
            <strong>{path ? lastStep(path) : robot}</strong>
          ) : (
            <button className="plain" data-level={path} onClick={() => show(path)}>
              {path ? lastStep(path) : robot}
            </button>
          )}
        </span>
      ))}
    </nav>
  );
}
