import { type ReactNode, useState } from "react";
import type { Operation } from "../../lib/api";
import { edit } from "../../lib/store";
import { levelPlace, type Part } from "../../lib/tree";
import { Asking } from "../../parts/Dialog";
import { Select, Text } from "../../parts/Field";

type Kind = Extract<Operation, { op: "group" }>["kind"];

const KINDS: [Kind, string][] = [
  ["series", "series: all must work"],
  ["parallel", "parallel: one is enough"],
  ["k_of_n", "k-of-n: at least k must work"],
  ["standby", "standby: the first work, the others wait"],
  ["load_sharing", "load sharing: the fewer, the faster they age"],
  ["network", "network: links lead from one end to the other; drawn then"],
];

export function GroupDialog({ members, level, close }: { members: Part[]; level: string; close: () => void }): ReactNode {
  const [kind, setKind] = useState<Kind>("parallel");
  const [k, setK] = useState("1");
  const asksK = kind !== "series" && kind !== "parallel" && kind !== "network";
  const names = members.map((one) => one.name);
  const number = Number(k);
  const wrong = asksK && !(Number.isInteger(number) && number >= 1 && number <= names.length) ? `a whole number from 1 to ${names.length}` : "";
  const group = (): void => void edit([{ op: "group", path: levelPlace(level), members: names, kind, k: asksK ? number : null }], `Group ${names.join(", ")}`);
  return (
    <Asking title="Put into a group" close={close} verb="Group" wrong={!!wrong} done={group}>
      <p>{names.join(", ")}</p>
      <Select label="How they are wired" value={kind} set={(value) => setKind(value as Kind)} options={KINDS} />
      {asksK && <Text label={kind === "standby" ? "How many work at a time" : "How many must work"} inputMode="numeric" value={k} set={setK} wrong={wrong} />}
    </Asking>
  );
}
