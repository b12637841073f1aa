import { type ReactNode, useId, useMemo, useState } from "react";
import { post } from "../lib/api";
import { redo, save, sayError, undo, useDesign } from "../lib/store";
import { everyPart, treeOf } from "../lib/tree";
import { Dialog } from "./Dialog";

interface Found {
  name: string;
  kind: string;
  run: () => void;
}

const MOST = 40;

export function Palette({ close, pages, go }: { close: () => void; pages: { id: string; name: string }[]; go: (page: string, rest?: string) => void }): ReactNode {
  const design = useDesign();
  const [text, setText] = useState("");
  const [at, setAt] = useState(0);
  const list = useId();

  const all = useMemo<Found[]>(() => {
    const parts = design ? [...everyPart(treeOf(design))].filter((part) => part.path) : [];
    return [
      ...pages.map((page) => ({ name: page.name, kind: "page", run: () => go(page.id) })),
      { name: "Save", kind: "command", run: () => void save() },
      { name: "Undo", kind: "command", run: () => void undo() },
      { name: "Redo", kind: "command", run: () => void redo() },
      { name: "Stop watching", kind: "command", run: () => void post("/api/monitoring/stop", undefined).catch(sayError) },
      { name: "Open the report", kind: "command", run: () => void window.open("./api/report", "_blank", "noopener") },
      ...parts.map((part) => ({ name: part.path, kind: part.kind, run: () => go("design", part.path) })),
    ];
  }, [design, pages, go]);

  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const found = all.filter((one) => words.every((word) => one.name.toLowerCase().includes(word))).slice(0, MOST);
  const chosen = found[Math.min(at, found.length - 1)];

  function run(one: Found | undefined): void {
    close();
    one?.run();
  }

  return (
    <Dialog title="Find anything" close={close} className="palette">
      <input
        role="combobox"
        aria-expanded="true"
        aria-controls={list}
        aria-activedescendant={chosen ? `${list}-${found.indexOf(chosen)}` : undefined}
        aria-label="A page, a part or a command"
        placeholder="A page, a part or a command"
        value={text}
        onChange={(event) => {
          setText(event.target.value);
          setAt(0);
        }}
        onKeyDown={(event) => {
          if (event.key === "ArrowDown") setAt(Math.min(at + 1, found.length - 1));
          else if (event.key === "ArrowUp") setAt(Math.max(at - 1, 0));
          else if (event.key === "Enter") run(chosen);
          else return;
          event.preventDefault();
        }}
      />
      <ul role="listbox" id={list} aria-label="Found">
        {found.map((one, i) => (
          <li key={`${one.kind} ${one.name}`} id={`${list}-${i}`} role="option" aria-selected={one === chosen} onClick={() => run(one)}>
            <span>{one.name}</span>
            <span className="small">{one.kind}</span>
          </li>
        ))}
        {!found.length && <li className="quiet">Nothing of that name.</li>}
      </ul>
    </Dialog>
  );
}
