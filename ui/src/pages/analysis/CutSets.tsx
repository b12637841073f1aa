import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../../lib/api";
import { useDesign } from "../../lib/store";
import { numberText, oddsText } from "../../lib/words";

export function CutSets(): ReactNode {
  const design = useDesign();
  const [found, setFound] = useState<Shapes["CutSets"] | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    get("/api/analysis/cut-sets", { most: 50 })
      .then((one) => {
        setFound(one);
        setWrong("");
      })
      .catch((error: Error) => setWrong(error.message));
  }, [design?.state]);
  const single = Object.entries(design?.levels ?? {}).filter(([, one]) => one.single_point).map(([path]) => path);
  return (
    <div className="stack">
      <section className="card">
        <h2>Single points of failure</h2>
        <p>{single.length ? `${single.length} parts fail the robot alone: ${single.slice(0, 30).join(", ")}${single.length > 30 ? " …" : ""}.` : "No part fails the robot alone."}</p>
      </section>
      {wrong && (
        <div className="trouble" role="alert">
          {wrong}
        </div>
      )}
      {found && (
        <section className="card scroll" tabIndex={0} role="region" aria-label="Minimal cut sets">
          <table>
            <caption>
              {found.counted}. Probability that all of one have failed since new. {found.left_out} {found.unknown}
              {!found.sets.length && " A new robot has no operating time yet: watch it or give it a past, and the likeliest sets stand here."}
            </caption>
            <thead>
              <tr>
                <th scope="col">Enough to fail</th>
                <th scope="col" className="number">Parts</th>
                <th scope="col" className="number">Probability</th>
              </tr>
            </thead>
            <tbody>
              {found.sets.map((one, i) => (
                <tr key={i}>
                  <th scope="row">{one.parts.join(", ")}</th>
                  <td className="number">{one.parts.length}</td>
                  <td className="number">
                    {numberText(one.probability)} {oddsText(one.probability) && `(${oddsText(one.probability)})`}
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </section>
      )}
    </div>
  );
}
