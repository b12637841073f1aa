import { type ReactNode, useEffect, useState } from "react";
import { get, post, type Shapes } from "../lib/api";
import { pulse } from "../lib/live";
import { sayError, useDesign, useShared } from "../lib/store";
import { OnlyFor } from "./OnlyFor";

/** What the service does with the robot, in words. */
export const MONITORING: Record<string, string> = { running: "Watching", failed: "Watching failed", stopped: "Stopped, not watched", ended: "Recording over" };

/** Start and stop of monitoring. It runs in the service, whether a browser looks or not. */
export function Watching(): ReactNode {
  const { monitoring } = useShared(pulse);
  const design = useDesign();
  const [found, setFound] = useState<Shapes["MonitoringState"] | null>(null);
  const [source, setSource] = useState("");
  const [speed, setSpeed] = useState("1");
  const [busy, setBusy] = useState(false);
  useEffect(() => {
    get("/api/monitoring")
      .then((state) => {
        setFound(state);
        setSource((old) => old || state.sources[0]?.name || "");
      })
      .catch(() => undefined);
  }, [monitoring]);
  const chosen = found?.sources.find((one) => one.name === source);

  async function run(work: () => Promise<Shapes["MonitoringState"]>): Promise<void> {
    setBusy(true);
    try {
      const state = await work();
      setFound(state);
      pulse.set({ ...pulse.get(), monitoring: state.state });
    } catch (error) {
      sayError(error);
    }
    setBusy(false);
  }

  if (monitoring === "running")
    return (
      <div className="row">
        <span className="quiet small">{found?.source}</span>
        <OnlyFor role="operator">
          <button disabled={busy} onClick={() => void run(() => post("/api/monitoring/stop", undefined))}>
            Stop
          </button>
        </OnlyFor>
      </div>
    );
  return (
    <div className="row" role="group" aria-label="Watch the robot">
      <OnlyFor role="operator">
        <select aria-label="Source of sensor data" value={source} onChange={(event) => setSource(event.target.value)}>
          {found?.sources.map((one) => (
            <option key={one.name} value={one.name}>
              {one.label}
            </option>
          ))}
        </select>
        {chosen?.paced && (
          <select aria-label="Speed" value={speed} onChange={(event) => setSpeed(event.target.value)}>
            {["1", "2", "5", "10", "50", "200", "1000"].map((one) => (
              <option key={one} value={one}>
                {one}× speed
              </option>
            ))}
          </select>
        )}
        <button
          className="primary"
          disabled={busy || !source || !design?.valid}
          onClick={() => void run(() => post("/api/monitoring/start", { source, speed: chosen?.paced ? Number(speed) : 1 }))}
        >
          Start analysis
        </button>
      </OnlyFor>
    </div>
  );
}
