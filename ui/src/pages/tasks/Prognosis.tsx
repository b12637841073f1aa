import { type ReactNode, useEffect, useMemo, useState } from "react";
import { get, post, remove, type Shapes } from "../../lib/api";
import { sayError } from "../../lib/store";
import { chanceWords, percentText } from "../../lib/words";
import { Check, Text } from "../../parts/Field";
import { OnlyFor } from "../../parts/OnlyFor";
import { Plot } from "../../parts/Plot";

/** The list again and again, the exposure carried on. */
export function Prognosis({ tasks, ready }: { tasks: Shapes["SaidTask"][]; ready: boolean }): ReactNode {
  const [repeat, setRepeat] = useState("1000");
  const [threshold, setThreshold] = useState("0.99");
  const [log, setLog] = useState(false);
  const [job, setJob] = useState<Shapes["JobState"] | null>(null);
  const running = job?.state === "waiting" || job?.state === "running";

  useEffect(() => {
    if (!job || !running) return;
    const timer = setTimeout(() => void get("/api/jobs/{number}", { number: job.number }).then(setJob).catch(sayError), 200);
    return () => clearTimeout(timer);
  }, [job, running]);

  const number = Number(repeat);
  const limit = Number(threshold);
  const wrongRuns = !(Number.isInteger(number) && number >= 1 && number <= 1e6) ? "a whole number up to 1,000,000" : "";
  const wrongLimit = threshold && !(limit > 0 && limit < 1) ? "between 0 and 1, or empty" : "";

  const found = job?.prognosis;
  const curves = useMemo(
    () =>
      found
        ? ([["nominal", found.nominal], ["sensor-based", found.sensor_based]] as const).map(([name, one], i) => ({
            name,
            x: found.repetitions.slice(0, one.probability.length),
            y: log ? one.failure : one.probability,
            dashed: i === 1,
            color: i,
          }))
        : [],
    [found, log],
  );
  return (
    <section className="card">
      <h2>Prognostic analysis</h2>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          post("/api/tasks/prognosis", { tasks, failed: [], working: [], future: "recent", repeat: number, threshold: threshold ? limit : null }).then(setJob).catch(sayError);
        }}
      >
        <div className="fields">
          <Text label="Times that the list is done" inputMode="numeric" value={repeat} set={setRepeat} wrong={wrongRuns} />
          <Text label="PoTC is to be at least" inputMode="decimal" value={threshold} set={setThreshold} wrong={wrongLimit} />
        </div>
        <div className="row">
          <OnlyFor role="operator">
            <button className="primary" type="submit" disabled={!ready || running || !!wrongRuns || !!wrongLimit}>
              Start
            </button>
            <button type="button" disabled={!running} onClick={() => job && void remove("/api/jobs/{number}", { number: job.number }).then(setJob).catch(sayError)}>
              Cancel
            </button>
          </OnlyFor>
          <Check label="show 1 − PoTC, logarithmic" value={log} set={setLog} />
        </div>
      </form>
      {job && running && <progress value={job.progress} max={1} aria-label="Progress of the prognostic analysis" />}
      {job?.state === "cancelled" && <p>Cancelled.</p>}
      {job?.error && <div className="trouble">{job.error}</div>}
      {found && (
        <div aria-live="polite">
          {([["nominal", found.nominal], ["sensor-based", found.sensor_based]] as const).map(([name, one]) => (
            <p key={name}>
              <strong>{name}</strong>: all {one.done.toLocaleString("en-US")} are completed with {chanceWords(one.together, found.unknown)}
              {found.threshold != null && (one.below_at ? `; below ${percentText(found.threshold)} from repetition ${one.below_at.toLocaleString("en-US")} on` : `; never below ${percentText(found.threshold)}`)}
            </p>
          ))}
          {found.unknown && <p className="small">{found.unknown.sentence}.</p>}
          <Plot title="PoTC of each repetition" curves={curves} xLabel="repetition" yLabel={log ? "1 − PoTC" : "PoTC, given that all before succeeded"} log={log} />
        </div>
      )}
      {!found && !job && <p className="quiet">How long can it go on with this list? Start, and see when PoTC falls below the limit.</p>}
    </section>
  );
}
