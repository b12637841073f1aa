// What colours the blocks of a diagram: their state now, or their share of the failures to come, as the service says.
import { type ReactNode, useEffect, useState, useSyncExternalStore } from "react";
import { get, type Shapes } from "../../../lib/api";
import { pulse } from "../../../lib/live";
import { Shared, useDesign, useShared } from "../../../lib/store";
import { durationText, numberText, shareText } from "../../../lib/words";
import { Icon } from "../../../parts/Icon";

export type Condition = Shapes["BlockCondition"];
export type Colour = "health" | "share" | "plain";

export const colouring = new Shared<Colour>("health");
const conditions = new Shared<{ of: Shapes["Conditions"] | null; blocks: Map<string, Condition> }>({ of: null, blocks: new Map() });

const EVERY = 1000;
const CLASSES = [0.01, 0.05, 0.2, 0.5]; // where a darker colour begins
const WORDS = { ok: "OK", warn: "WARN", error: "ERROR", stale: "STALE", idle: "" } as const;

/** Asks for the conditions of a level as long as its diagram is shown; of a robot that nobody watches for shares alone. */
export function useConditions(level: string, whole: boolean): void {
  const design = useDesign();
  const colour = useShared(colouring);
  const { looks, monitoring } = useShared(pulse);
  const [beat, setBeat] = useState(0);
  const running = monitoring === "running";
  useEffect(() => {
    if (!running) return;
    const timer = setInterval(() => setBeat((n) => n + 1), EVERY);
    return () => clearInterval(timer);
  }, [running]);
  const asks = colour === "share" ? !!design?.valid || monitoring !== "idle" : colour === "health" && monitoring !== "idle";
  useEffect(() => {
    if (!asks) return conditions.set({ of: null, blocks: new Map() });
    const asked = new AbortController();
    get("/api/condition", { path: level, whole }, asked.signal)
      .then((found) => {
        const old = conditions.get().blocks; // what is as it was stays the same, and is not drawn again
        const same = (one: Condition): Condition => {
          const before = old.get(one.path);
          return before && JSON.stringify(before) === JSON.stringify(one) ? before : one;
        };
        conditions.set({ of: found, blocks: new Map(found.blocks.map((one) => [one.path, same(one)])) });
      })
      .catch(() => !asked.signal.aborted && conditions.set({ of: null, blocks: new Map() }));
    return () => asked.abort();
  }, [asks, running ? beat : looks, level, whole, design?.state]);
}

/** The condition of one block; it is drawn again when that changes, and not when another's does. */
export function useCondition(path: string): Condition | undefined {
  return useSyncExternalStore(conditions.listen, () => conditions.get().blocks.get(path));
}

/** The conditions of all blocks of the level that is shown, by path. */
export const useBlocks = (): Map<string, Condition> => useShared(conditions).blocks;

const classOf = (share: number): number => CLASSES.filter((from) => share >= from).length;
const percent = (share: number): string => (share > 0 && share < 0.001 ? "< 0.1 %" : shareText(share));

export function markOf(condition: Condition | undefined, colour: Colour): string {
  if (!condition || colour === "plain") return "";
  if (colour === "share") return condition.share == null ? "" : `share share-${classOf(condition.share)}`;
  return `now-${condition.state}`;
}

/** What stands in a block beside its name: its share as a bar and a number, or its state as an icon and a word. */
export function Value({ condition, colour, plain, rate }: { condition: Condition | undefined; colour: Colour; plain: string; rate: (rate: number | null) => string }): ReactNode {
  if (!condition || colour === "plain") return plain;
  if (colour === "share")
    return condition.share == null ? "share not known" : (
      <>
        {percent(condition.share)} of failures
        <span className="meter" style={{ width: `${100 * condition.share}%` }} />
      </>
    );
  const times = condition.hazard_rate != null && condition.nominal_hazard_rate ? condition.hazard_rate / condition.nominal_hazard_rate : 1;
  return (
    <>
      {rate(condition.hazard_rate)}
      {Math.abs(times - 1) >= 0.01 && ` ×${numberText(times, 2)}`}
      {condition.state !== "idle" && (
        <span className={`state ${condition.state}`}>
          <Icon name={condition.state} />
          {WORDS[condition.state]}
        </span>
      )}
    </>
  );
}

/** By what blocks are coloured, and what the colours mean. */
export function Legend(): ReactNode {
  const colour = useShared(colouring);
  const { of } = useShared(conditions);
  return (
    <>
      <label className="row colouring">
        Coloured by
        <select value={colour} onChange={(event) => colouring.set(event.target.value as Colour)}>
          <option value="health">health now</option>
          <option value="share">share of failures to come</option>
          <option value="plain">nothing</option>
        </select>
      </label>
      {colour === "share" && of?.horizon != null && (
        <span className="legend">
          {["< 1 %", "1–5 %", "5–20 %", "20–50 %", "≥ 50 %"].map((text, i) => (
            <span key={text}>
              <i className={`swatch share-${i}`} aria-hidden="true" /> {text}
            </span>
          ))}
          <span>
            of the failures within {durationText(of.horizon)}
            {!of.stated && ", the median remaining life"}
          </span>
          {of.notes?.map((one) => <span key={one}>{one}</span>)}
        </span>
      )}
      {colour === "health" && (
        <span className="legend">
          {!of ? "Nobody watches the robot: blocks show what they were designed for." : "× beside a rate: how many times as fast as designed. No word: no limit is set for it."}
        </span>
      )}
    </>
  );
}
