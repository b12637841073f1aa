import { type ReactNode, useEffect, useState } from "react";
import { useRefusal, visitor } from "../../lib/access";
import { get, type Shapes } from "../../lib/api";
import { sayError, useDesign, useShared } from "../../lib/store";
import { momentText } from "../../lib/words";

type Change = Shapes["LoggedChange"];

const MOST = 200;

/** Who did what on the page, the latest first: the log that `robophm audit` shows. */
export function Changes(): ReactNode {
  const design = useDesign();
  const refusal = useRefusal("editor");
  const known = useShared(visitor) !== null;
  const [found, setFound] = useState<Change[]>([]);
  useEffect(() => {
    if (known && !refusal) get("/api/access/changes", { most: MOST }).then((all) => setFound(all.changes), sayError);
  }, [known, refusal, design?.revision]);
  return (
    <section className="card">
      <h2>Who changed what</h2>
      {refusal && <p className="quiet">{refusal}.</p>}
      {!refusal && !found.length && <p className="quiet">Nothing was changed on this page so far.</p>}
      {found.length > 0 && (
        <ul className="alarms changelog" aria-label="Changes, the latest first" tabIndex={0}>
          {found.map((one, i) => (
            <li key={i}>
              <div className="grow">
                <strong>{one.what}</strong>
                <p className="small quiet">
                  {momentText(one.time)}, {whom(one)}
                </p>
                {one.values.map((value) => (
                  <p key={value.place} className="small">
                    {value.place}: {value.before ?? "–"} → {value.after ?? "–"}
                  </p>
                ))}
                {one.more > 0 && <p className="small">and {one.more} more</p>}
              </div>
            </li>
          ))}
        </ul>
      )}
      {found.length === MOST && <p className="small quiet">Older ones: robophm audit --last 1000.</p>}
    </section>
  );
}

function whom(one: Change): string {
  if (!one.address) return "somebody, in the file";
  return `${one.who || "anybody"}${one.role && one.who ? ` (${one.role})` : ""} from ${one.address}`;
}
