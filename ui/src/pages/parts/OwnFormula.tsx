import { type ReactNode, useState } from "react";
import type { Values } from "../../lib/tree";
import { FormulaForm } from "../../parts/FormulaForm";
import { AddTo } from "./AddTo";

export function OwnFormula(): ReactNode {
  const [hazard, setHazard] = useState<Values | null>(null);
  return (
    <div className="card" style={{ maxWidth: 760 }}>
      <h2>A component of your own</h2>
      <FormulaForm given={{}} use="Add to the robot…" done={setHazard} />
      {hazard && <AddTo hazard={hazard} wanted="own component" close={() => setHazard(null)} />}
    </div>
  );
}
