import { type ReactNode, useMemo } from "react";
import { useDesign } from "../../lib/store";
import { everyPart, treeOf } from "../../lib/tree";
import { Select } from "../../parts/Field";

/** The robot or one of its modules; of parts too where they are asked for. */
export function LevelSelect({ label, value, set, parts = false }: { label: string; value: string; set: (path: string) => void; parts?: boolean }): ReactNode {
  const design = useDesign();
  const options = useMemo<[string, string][]>(
    () => (design ? [...everyPart(treeOf(design))].filter((one) => parts || one.kind !== "component").map((one) => [one.path, one.path || `${one.name} (the robot)`]) : []),
    [design, parts],
  );
  return <Select label={label} value={value} set={set} options={options} />;
}
