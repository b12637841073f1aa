import { type ReactNode, useState } from "react";
import { edit, useUnit } from "../../lib/store";
import { FIGURES, insteadOfRate, isValues, type Part } from "../../lib/tree";
import { Dialog } from "../../parts/Dialog";
import { Entry } from "../../parts/Field";
import { FormulaForm } from "../../parts/FormulaForm";
import { Library } from "../../parts/Library";

/** Where a part's rate comes from: stated, a handbook's model, or the user's own formula. */
export function RateOf({ part }: { part: Part }): ReactNode {
  const unit = useUnit();
  const [dialog, setDialog] = useState<"" | "model" | "formula">("");
  const hazard = isValues(part.values.hazard) ? part.values.hazard : null;
  const modes = isValues(part.values.failure_modes) ? Object.keys(part.values.failure_modes) : [];
  const set = (value: Record<string, unknown>, what: string): void => {
    const drop = FIGURES.filter((one) => !(one in value) && part.values[one] !== undefined);
    void edit(
      [
        ...drop.map((one) => ({ op: "delete" as const, path: [...part.place, one] })),
        ...Object.entries(value).map(([key, one]) => ({ op: "put" as const, path: [...part.place, key], value: one })),
      ],
      what,
    );
    setDialog("");
  };
  const instead = insteadOfRate(part.values);
  return (
    <>
      <h3>Hazard rate</h3>
      {modes.length > 0 && <p className="small">Failure modes: {modes.join(", ")}; edit them as text below.</p>}
      {!modes.length && (
        <Entry
          label="Stated rate of one"
          hint={instead ? `now by ${instead}; a stated rate takes its place` : `with its unit, e.g. 12 FIT, 0.3 FPMH, 5.8e-6 /h (shown in ${unit}); or the word unknown`}
          value={String(part.values.rate ?? "")}
          set={(value) => value && set({ rate: value }, `Rate of ${part.name}`)}
        />
      )}
      <Entry label="Source of the rate" value={String(part.values.source ?? "")} set={(value) => void edit(value ? [{ op: "put", path: [...part.place, "source"], value }] : [{ op: "delete", path: [...part.place, "source"] }], `Source of ${part.name}`)} />
      <div className="row">
        <button onClick={() => setDialog("model")}>{hazard?.model ? "Change the model…" : "By a handbook model…"}</button>
        <button onClick={() => setDialog("formula")}>{hazard?.formula ? "Change the formula…" : "By a formula…"}</button>
      </div>
      {dialog === "model" && (
        <Dialog title={`Hazard model of ${part.name}`} close={() => setDialog("")}>
          <Library
            start={hazard?.model ? String(hazard.model) : ""}
            given={isValues(hazard?.inputs) ? Object.fromEntries(Object.entries(hazard.inputs).map(([key, one]) => [key, String(one)])) : {}}
            use="Use this rate"
            done={(model, inputs) => set({ hazard: { model, inputs } }, `Model of ${part.name}`)}
          />
        </Dialog>
      )}
      {dialog === "formula" && (
        <Dialog title={`Formula of ${part.name}`} close={() => setDialog("")}>
          <FormulaForm given={hazard ?? {}} use="Use this formula" done={(found) => set({ hazard: found }, `Formula of ${part.name}`)} />
        </Dialog>
      )}
    </>
  );
}
