// The log of alarms and the limits that begin them, asked for when health has changed.
import { useEffect, useState } from "react";
import { get, type Shapes } from "./api";
import { useHealth } from "./health";
import { sayError, useDesign } from "./store";

export type Alarm = Shapes["LoggedAlarm"];
export type Alarms = Shapes["AlarmsOfRobot"];

/** Of those that have ended the newest, ``most`` with those that go on; as many as the service gives without. */
export function useAlarms(most?: number): [Alarms | null, (found: Alarms) => void] {
  const design = useDesign();
  const { health } = useHealth();
  const [found, setFound] = useState<Alarms | null>(null);
  useEffect(() => {
    if (!health && !design?.valid) return;
    const asked = new AbortController();
    get("/api/alarms", most ? { most } : {}, asked.signal).then(setFound).catch((error: unknown) => !asked.signal.aborted && sayError(error));
    return () => asked.abort();
  }, [health?.looks, health?.alarms, health?.unacknowledged, health?.monitoring, design?.state]);
  return [found, setFound];
}

export function useLimits(): Alarms["limits"] {
  const design = useDesign();
  const { health } = useHealth();
  const [limits, setLimits] = useState<Alarms["limits"]>([]);
  useEffect(() => {
    if (!health) return;
    const asked = new AbortController();
    get("/api/alarms", { most: 1 }, asked.signal).then((found) => setLimits(found.limits)).catch(() => undefined);
    return () => asked.abort();
  }, [!health, health?.monitoring, design?.state]);
  return limits;
}
