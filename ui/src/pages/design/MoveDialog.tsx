import { type ReactNode, useState } from "react";
import { useDesign } from "../../lib/store";
import { findPart, levelOf, type Part } from "../../lib/tree";
import { Asking } from "../../parts/Dialog";
import { Select } from "../../parts/Field";
import { LevelSelect } from "../parts/LevelSelect";
import { move } from "./moving";

/** What dragging does on the canvas: to another level, or elsewhere in the diagram. */
export function MoveDialog({ parts, close, moved }: { parts: Part[]; close: () => void; moved: (paths: string[]) => void }): ReactNode {
  const design = useDesign();
  const from = levelOf(parts[0]!.path);
  const [level, setLevel] = useState(from);
  const [beside, setBeside] = useState("");
  const chosen = new Set(parts.map((one) => one.path));
  const others = design ? (findPart(design, level)?.parts ?? []).filter((one) => !chosen.has(one.path)) : [];
  const inside = parts.find((one) => level === one.path || level.startsWith(`${one.path}/`));
  return (
    <Asking
      title={`Move ${parts.map((one) => one.name).join(", ")}`}
      close={close}
      verb="Move"
      wrong={!!inside}
      done={() => void move(parts, level, beside ? { beside: [beside], before: false } : null).then((paths) => paths && moved(paths))}
    >
      <LevelSelect
        label="To the level"
        value={level}
        set={(path) => {
          setLevel(path);
          setBeside("");
        }}
      />
      <Select
        label="Drawn"
        value={beside}
        set={setBeside}
        options={[["", "at the end, in series"], ...others.map((one): [string, string] => [one.name, `behind ${one.name}, in its group`])]}
        hint={inside ? `${inside.name} cannot be moved into itself` : undefined}
      />
    </Asking>
  );
}
