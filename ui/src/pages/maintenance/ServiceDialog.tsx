import { type ReactNode, useState } from "react";
import { post } from "../../lib/api";
import { prefer, preferences, say, sayError, useShared } from "../../lib/store";
import { Asking } from "../../parts/Dialog";
import { Check, Select, Text } from "../../parts/Field";
import type { Due } from "../Maintenance";

const KINDS: [string, string][] = [["replaced", "replaced by a new one"], ["repaired", "repaired"]];

/** Note that a part was replaced or repaired; whoever watches the robot takes it in, once. */
export function ServiceDialog({ due, close, done }: { due: Due; close: () => void; done: () => void }): ReactNode {
  const { name } = useShared(preferences);
  const [part, setPart] = useState(due.part);
  const [kind, setKind] = useState("replaced");
  const [share, setShare] = useState("0");
  const [failed, setFailed] = useState(false);
  const [note, setNote] = useState("");
  const [key] = useState(() => [...crypto.getRandomValues(new Uint8Array(16))].map((one) => one.toString(16).padStart(2, "0")).join(""));
  const remaining = Number(share) / 100;
  const wrong = kind === "repaired" && !(share.trim() && remaining >= 0 && remaining <= 1);

  async function send(): Promise<void> {
    try {
      const said = await post("/api/maintenance/service", { part: part.trim(), remaining: kind === "repaired" ? remaining : null, failed, by: name.trim(), note: note.trim(), key });
      say(`Noted: ${said.map((one) => `${one.mode} ${one.kind}`).join(", ")}`);
      done();
    } catch (error) {
      sayError(error);
    }
  }

  return (
    <Asking title="Note a service" close={close} verb="Note it" wrong={wrong || !part.trim()} done={() => void send()}>
      <Select label="What was done" value={kind} options={KINDS} set={setKind} />
      <Text label="Part" hint="or one failure mode of it" value={part} set={setPart} />
      {kind === "repaired" && (
        <Text label="Share of its age that remains, %" inputMode="decimal" hint="0: as good as new; 100: it only works again" value={share} set={setShare} wrong={wrong ? "expected 0 to 100" : undefined} />
      )}
      <Check label="It had failed" value={failed} set={setFailed} />
      <Text label="By" placeholder="your name" maxLength={100} value={name} set={(said) => prefer({ name: said })} />
      <Text label="Note" maxLength={1000} value={note} set={setNote} />
      <p className="small quiet">It counts from now on: note it when it is done. If parts of a quantity are equal, all of them are meant.</p>
    </Asking>
  );
}
