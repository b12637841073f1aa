import { type ReactNode, useEffect } from "react";
import { useAsking, useHealth } from "./lib/health";
import { pulse } from "./lib/live";
import { useDesign, useShared } from "./lib/store";
import { useTitle } from "./lib/title";
import { durationText, momentText, shareText } from "./lib/words";
import { Bars } from "./parts/Bars";
import { State } from "./parts/Icon";
import { Unreachable } from "./parts/Unreachable";
import { MONITORING } from "./parts/Watching";
import { Cards } from "./pages/overview/Cards";
import "./wall.css";

/** What is to be seen from afar, or inside another page: nothing leads away from it, and nothing can be changed on it. */
export default function Wall(): ReactNode {
  useAsking();
  const design = useDesign();
  const { health, error } = useHealth();
  const { monitoring } = useShared(pulse);
  useTitle("Wall", design?.name);
  useEffect(() => {
    document.body.classList.add("wall");
    return () => document.body.classList.remove("wall");
  }, []);
  const silent = health?.sensors.filter((one) => one.stale && one.age != null) ?? [];
  return (
    <main id="main" tabIndex={0}>
      <div className="head">
        <h1>{design?.name ?? "robophm"}</h1>
        {health && <State of={health.state} limited={health.limits_set} />}
        {MONITORING[monitoring] && <span className="quiet">{MONITORING[monitoring]}</span>}
        <span className="grow" />
        {health?.time != null && <span className="quiet">up to {momentText(health.time)}</span>}
      </div>
      <Unreachable />
      {design && !design.valid && <p className="trouble">The design is not complete: no figures can be given.</p>}
      {error && design?.valid && <p className="trouble">{error}</p>}
      {health && (
        <>
          {health.sentence && <p className="sentence">{health.sentence.replaceAll(" %", "\u00a0%")}</p>}
          {(health.why.length > 0 || silent.length > 0) && (
            <div className="trouble">
              {health.why.map((one) => (
                <p key={one}>{one}</p>
              ))}
              {silent.length > 0 && <p>Silent: {silent.map((one) => one.signal).join(", ")}</p>}
            </div>
          )}
          <Cards health={health} />
          {health.to_come && health.to_come.parts.length > 0 && (
            <section className="card">
              <h2>What will fail it, within {durationText(health.to_come.horizon)}</h2>
              <Bars
                title="Share of the failures to come"
                names={["nominal", "sensor-based"]}
                bars={health.to_come.parts.map((one) => ({ name: one.path, values: [one.nominal, one.sensor_based], words: shareText(one.sensor_based) }))}
              />
            </section>
          )}
        </>
      )}
    </main>
  );
}
