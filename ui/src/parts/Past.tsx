import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { pulse } from "../lib/live";
import { edit, useDesign, useShared } from "../lib/store";
import { Dialog } from "./Dialog";
import { Icon } from "./Icon";
import { OnlyFor } from "./OnlyFor";

type Part = Shapes["PastOfPart"];

/** What becomes of the robot's past under the design as it is edited; there only where anything becomes of it. */
export function PastButton(): ReactNode {
  const design = useDesign();
  const { monitoring } = useShared(pulse);
  const [found, setFound] = useState<Shapes["PastOfDesign"] | null>(null);
  const [open, setOpen] = useState(false);
  useEffect(() => {
    let late = false;
    get("/api/design/past")
      .then((past) => late || setFound(past))
      .catch(() => undefined);
    return () => {
      late = true;
    };
  }, [design?.revision, monitoring]);
  const asked = found?.parts.filter((one) => one.kind === "asked" || one.kind === "refused").length ?? 0;
  if (!found || (!found.parts.length && !found.trouble)) return null;
  const words = found.trouble ? "not known" : asked ? `${asked} to answer` : `${found.parts.length} changed`;
  return (
    <>
      <button onClick={() => setOpen(true)} aria-label={`What becomes of the past: ${words}`}>
        <span className={`state ${asked || found.trouble ? "warn" : "idle"}`}>
          {(asked > 0 || found.trouble) && <Icon name="warn" />}
          Past: {words}
        </span>
      </button>
      {open && <PastDialog found={found} close={() => setOpen(false)} />}
    </>
  );
}

function PastDialog({ found, close }: { found: Shapes["PastOfDesign"]; close: () => void }): ReactNode {
  const [answers, setAnswers] = useState<Record<string, string>>({});
  const asked = found.parts.filter((one) => one.kind === "asked");
  const answer = (one: Part): string => answers[one.path] ?? one.candidates[0] ?? one.path;
  const apply = (): void => {
    close();
    const operations = asked.map((one) => ({ op: "put" as const, path: [...one.place, "identity"], value: answer(one) }));
    void edit(operations, "Answer what is asked about the past");
  };
  return (
    <Dialog title="What becomes of the past" close={close}>
      {found.trouble && <p className="trouble">{found.trouble}</p>}
      {found.parts.length > 0 && (
        <>
          <p>Under this design, when analysis is started next. Every other part goes on as it is.</p>
          <table>
            <thead>
              <tr>
                <th scope="col">Part</th>
                <th scope="col">Its past</th>
                {asked.length > 0 && <th scope="col">Answer</th>}
              </tr>
            </thead>
            <tbody>
              {found.parts.map((one) => (
                <tr key={`${one.kind} ${one.path}`}>
                  <th scope="row">{one.path}</th>
                  <td>{one.said}</td>
                  {asked.length > 0 && (
                    <td>
                      {one.kind === "asked" && (
                        <select aria-label={`Which part ${one.path} is`} value={answer(one)} onChange={(event) => setAnswers({ ...answers, [one.path]: event.target.value })}>
                          {one.candidates.map((name) => (
                            <option key={name} value={name}>
                              it is {name}
                            </option>
                          ))}
                          <option value={one.candidates.includes(one.path) ? `${one.path} 2` : one.path}>it is new</option>
                        </select>
                      )}
                    </td>
                  )}
                </tr>
              ))}
            </tbody>
          </table>
          {asked.length > 0 && (
            <div className="row">
              <OnlyFor role="editor">
                <button className="primary" onClick={apply}>
                  Answer
                </button>
              </OnlyFor>
              <button onClick={close}>Cancel</button>
            </div>
          )}
        </>
      )}
    </Dialog>
  );
}
