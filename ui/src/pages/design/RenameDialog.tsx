import { type ReactNode, useState } from "react";
import { edit } from "../../lib/store";
import type { Part } from "../../lib/tree";
import { Dialog } from "../../parts/Dialog";
import { Text } from "../../parts/Field";

export function RenameDialog({ part, close, done }: { part: Part; close: () => void; done: (name: string) => void }): ReactNode {
  const [name, setName] = useState(part.name);
  const wrong = !name.trim() ? "a name" : /[/[\]]/.test(name) ? "a name without / [ ]" : "";
  return (
    <Dialog title={`Name of this ${part.kind}`} close={close}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (wrong) return;
          close();
          const wanted = name.trim();
          if (wanted !== part.name)
            void edit([{ op: "rename", path: part.place, name: wanted }], `Rename ${part.name} to ${wanted}`).then((made) => made && done(wanted));
        }}
      >
        <Text label="Name" value={name} set={setName} wrong={wrong} />
        <div className="row">
          <button className="primary" type="submit" disabled={!!wrong}>
            Name it so
          </button>
          <button type="button" onClick={close}>
            Leave it
          </button>
        </div>
      </form>
    </Dialog>
  );
}
