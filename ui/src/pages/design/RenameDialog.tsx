import { type ReactNode, useState } from "react";
import { edit } from "../../lib/store";
import type { Part } from "../../lib/tree";
import { Asking } from "../../parts/Dialog";
import { Text } from "../../parts/Field";

export function RenameDialog({ part, close, done }: { part: Part; close: () => void; done: (name: string) => void }): ReactNode {
  const [name, setName] = useState(part.name);
  const wrong = !name.trim() ? "a name" : /[/[\]]/.test(name) ? "a name without / [ ]" : "";
  const rename = (): void => {
    const wanted = name.trim();
    if (wanted !== part.name) void edit([{ op: "rename", path: part.place, name: wanted }], `Rename ${part.name} to ${wanted}`).then((made) => made && done(wanted));
  };
  return (
    <Asking title={`Name of this ${part.kind}`} close={close} verb="Name it so" wrong={!!wrong} done={rename}>
      <Text label="Name" value={name} set={setName} wrong={wrong} />
    </Asking>
  );
}
