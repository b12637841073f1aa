import { type ReactNode, useState } from "react";
import { get } from "../../lib/api";
import { edit, replaceText, sayError } from "../../lib/store";
import type { Part } from "../../lib/tree";
import { Area } from "../../parts/Field";

/** Whatever a form does not ask for can be written here, as in the design file. */
export function AsText({ part }: { part: Part }): ReactNode {
  const [text, setText] = useState<string | null>(null);
  const open = async (): Promise<void> => {
    try {
      setText((await get("/api/design/part", { path: part.place })).text);
    } catch (error) {
      sayError(error);
    }
  };
  const keep = async (): Promise<void> => {
    const what = `Edit ${part.name} as text`;
    const done = part.place.length ? await edit([{ op: "put_text", path: part.place, text: text ?? "" }], what) : await replaceText(text ?? "", what);
    if (done) setText(null);
  };
  if (text === null)
    return (
      <p>
        <button onClick={() => void open()}>Edit as text…</button>
      </p>
    );
  return (
    <div style={{ marginTop: 12 }}>
      <Area label="As in the design file (YAML)" value={text} set={setText} rows={14} />
      <div className="row">
        <button className="primary" onClick={() => void keep()}>
          Take this
        </button>
        <button onClick={() => setText(null)}>Leave it</button>
      </div>
    </div>
  );
}
