import { type ReactNode, useState } from "react";
import type { Values } from "../../lib/tree";
import { Library } from "../../parts/Library";
import { AddTo } from "./AddTo";

export function UseLibrary(): ReactNode {
  const [found, setFound] = useState<{ hazard: Values; name: string } | null>(null);
  return (
    <>
      <Library use="Add to the robot…" done={(model, inputs) => setFound({ hazard: { model, inputs }, name: model.slice(model.lastIndexOf(".") + 1).replaceAll("_", " ") })} />
      {found && <AddTo hazard={found.hazard} wanted={found.name} close={() => setFound(null)} />}
    </>
  );
}
