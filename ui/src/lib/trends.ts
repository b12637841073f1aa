// How the robot's figures have changed: asked for all cards at once, of one robot not more than once a minute.
import { useEffect } from "react";
import { get, type Shapes } from "./api";
import { pulse } from "./live";
import { Shared, useDesign, useShared } from "./store";
import { durationText, numberText } from "./words";

export type Trends = Shapes["Trends"];
export type Card = "hazard_rate" | "reliability" | "remaining_life" | "completion";

const EVERY = 60_000;
const FRESH = 3600;

const kept = new Shared<{ of: string; at: number; trends: Trends | null }>({ of: "", at: 0, trends: null });

export function useTrends(): Trends | null {
  const design = useDesign();
  const { monitoring } = useShared(pulse);
  const of = design?.valid ? `${design.name} ${monitoring}` : "";
  useEffect(() => {
    if (!of) return;
    const ask = (): void => {
      const before = kept.get();
      kept.set({ of, at: Date.now(), trends: before.of === of ? before.trends : null });
      get("/api/history/trends", {})
        .then((trends) => kept.get().of === of && kept.set({ ...kept.get(), trends }))
        .catch(() => undefined); // a past that cannot be read is said where it is looked at
      timer = setTimeout(ask, EVERY);
    };
    const before = kept.get();
    let timer = setTimeout(ask, before.of === of ? Math.max(before.at + EVERY - Date.now(), 0) : 0);
    return () => clearTimeout(timer);
  }, [of]);
  const { of: known, trends } = useShared(kept);
  return known === of ? trends : null;
}

const CHANGE: Record<Card, (size: number) => string> = {
  hazard_rate: (size) => `${numberText(100 * size, 2)} %`,
  reliability: (size) => `${numberText(100 * size, 2)} % points`,
  remaining_life: durationText,
  completion: (size) => `${numberText(100 * size, 2)} % points`,
};

/** "since yesterday", "↑ 6 %"; nothing where the history does not tell. */
export function trendRows(trends: Trends | null, card: Card): [string, string][] {
  const found = trends?.figures[card];
  if (!found || trends.until == null) return [];
  const now = Math.abs(Date.now() / 1000 - trends.until) < FRESH;
  const row = (change: number | null, words: string): [string, string][] =>
    change == null ? [] : [[words, change === 0 ? "unchanged" : `${change > 0 ? "↑" : "↓"} ${CHANGE[card](Math.abs(change))}`]];
  return [...row(found.day, now ? "since yesterday" : "in its last day"), ...row(found.month, now ? "since last month" : "in its last month")];
}
