import { type ReactNode, useState } from "react";
import type { Problem } from "../lib/api";
import { go, useDesign } from "../lib/store";
import { isEmpty, partOfPlace } from "../lib/tree";
import { Dialog } from "./Dialog";
import { Icon } from "./Icon";

export function ProblemsButton(): ReactNode {
  const design = useDesign();
  const [open, setOpen] = useState(false);
  const errors = design?.problems.filter((one) => one.level === "error").length ?? 0;
  const warnings = (design?.problems.length ?? 0) - errors;
  if (!design) return null;
  if (isEmpty(design)) return <button onClick={() => go("new")}>No robot yet: begin here</button>;
  const words = errors ? `${errors} to mend` : warnings ? `${warnings} odd` : "No problems";
  return (
    <>
      <button onClick={() => setOpen(true)} aria-label={`Problems of the design: ${words}`}>
        <span className={`state ${errors ? "error" : warnings ? "warn" : "idle"}`}>
          {errors + warnings > 0 && <Icon name={errors ? "error" : "warn"} />}
          Design: {words}
        </span>
      </button>
      {open && (
        <Dialog title="Problems of the design" close={() => setOpen(false)}>
          <ProblemList problems={design.problems} chosen={() => setOpen(false)} />
        </Dialog>
      )}
    </>
  );
}

export function ProblemList({ problems, chosen }: { problems: Problem[]; chosen?: () => void }): ReactNode {
  if (!problems.length) return <p>Nothing is wrong or odd: every part is drawn, has a rate with its unit, and is used once.</p>;
  return (
    <table className="problems">
      <thead>
        <tr>
          <th scope="col">What</th>
          <th scope="col">Where</th>
          <th scope="col">Line</th>
        </tr>
      </thead>
      <tbody>
        {problems.map((one, i) => (
          <tr key={i}>
            <td>
              <span className={`state ${one.level === "error" ? "error" : "warn"}`}>
                <Icon name={one.level === "error" ? "error" : "warn"} />
              </span>{" "}
              {one.message}
            </td>
            <td>
              <button
                className="plain"
                onClick={() => {
                  go("design", partOfPlace(one.place));
                  chosen?.();
                }}
              >
                {one.place.join(" / ") || "the robot"}
              </button>
            </td>
            <td className="number">{one.line ?? ""}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** What is wrong or odd in the part that is looked at: where is known, but for the line. */
export function ProblemsHere({ problems }: { problems: Problem[] }): ReactNode {
  return (
    <ul className="mistakes">
      {problems.map((one, i) => (
        <li key={i} className={one.level}>
          <Icon name={one.level === "error" ? "error" : "warn"} />
          <span>
            {one.message}
            {one.line != null && <span className="quiet"> (line {one.line})</span>}
          </span>
        </li>
      ))}
    </ul>
  );
}
