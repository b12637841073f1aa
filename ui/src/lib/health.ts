// The robot's health, asked for again when there is something new.
import { useEffect, useState } from "react";
import { get, type Health } from "./api";
import { pulse } from "./live";
import { Shared, useDesign, useShared } from "./store";

const EVERY = 1000;

export interface Known {
  health: Health | null;
  error: string;
}

export const known = new Shared<Known>({ health: null, error: "" });

/** How far ahead to look for what will fail it [h]; null: the median remaining life. */
export const horizon = new Shared<number | null>(null);

/** Asks; once, for the whole page. */
export function useAsking(): void {
  const { looks, monitoring } = useShared(pulse);
  const design = useDesign();
  const ahead = useShared(horizon);
  const [beat, setBeat] = useState(0);
  const running = monitoring === "running";
  useEffect(() => {
    if (!running) return;
    const timer = setInterval(() => setBeat((n) => n + 1), EVERY);
    return () => clearInterval(timer);
  }, [running]);
  const due = running ? beat : looks;
  const valid = design?.valid ?? false;
  useEffect(() => {
    if (!valid && monitoring === "idle") {
      known.set({ health: null, error: "" }); // nothing can be known of what is no robot yet
      return;
    }
    const asked = new AbortController();
    get("/api/health", { horizon: ahead }, asked.signal)
      .then((health) => known.set({ health, error: "" }))
      .catch((error: unknown) => !asked.signal.aborted && known.set({ ...known.get(), error: String(error instanceof Error ? error.message : error) }));
    return () => asked.abort();
  }, [due, monitoring, design?.state, valid, ahead]);
}

export const useHealth = (): Known => useShared(known);
