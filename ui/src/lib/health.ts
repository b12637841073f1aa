// The robot's health, asked for again when there is something new.
import { useEffect, useState } from "react";
import { get, type Health } from "./api";
import { pulse } from "./live";
import { useDesign, useShared } from "./store";

const EVERY = 1000;

export function useHealth(): { health: Health | null; error: string } {
  const { looks, monitoring } = useShared(pulse);
  const design = useDesign();
  const [found, setFound] = useState<{ health: Health | null; error: string }>({ health: null, error: "" });
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
      setFound({ health: null, error: "" }); // nothing can be known of what is no robot yet
      return;
    }
    const asked = new AbortController();
    get("/api/health", {}, asked.signal)
      .then((health) => setFound({ health, error: "" }))
      .catch((error: unknown) => !asked.signal.aborted && setFound((old) => ({ ...old, error: String(error instanceof Error ? error.message : error) })));
    return () => asked.abort();
  }, [due, monitoring, design?.state, valid]);
  return found;
}
