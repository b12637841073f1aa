import { type ReactNode, useState } from "react";
import { edit, go, useDesign } from "../../lib/store";
import { findPart, freeName, type Values } from "../../lib/tree";
import { Dialog } from "../../parts/Dialog";
import { Text } from "../../parts/Field";
import { LevelSelect } from "./LevelSelect";
import { OnlyFor } from "../../parts/OnlyFor";

/** Where a new component goes, what it is called, and how many there are. */
export function AddTo({ hazard, wanted, close }: { hazard: Values; wanted: string; close: () => void }): ReactNode {
  const design = useDesign();
  const [level, setLevel] = useState("");
  const [name, setName] = useState(wanted);
  const [quantity, setQuantity] = useState("1");
  const host = design && findPart(design, level);
  const wrong = !/^[1-9]\d*$/.test(quantity) ? "a whole number above zero" : "";
  return (
    <Dialog title="Add to the robot" close={close}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (!host || wrong || !name.trim()) return;
          const free = freeName(host, name.trim());
          close();
          void edit([{ op: "put", path: [...host.place, "components", free], value: { quantity: Number(quantity), hazard } }], `Add ${free}`).then(
            (made) => made && go("design", host.path ? `${host.path}/${free}` : free),
          );
        }}
      >
        <LevelSelect label="Into" value={level} set={setLevel} />
        <Text label="Name" value={name} set={setName} />
        <Text label="Quantity" inputMode="numeric" value={quantity} set={setQuantity} wrong={wrong} />
        <OnlyFor role="editor">
          <button className="primary" type="submit">
            Add
          </button>
        </OnlyFor>
      </form>
    </Dialog>
  );
}
