import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../../lib/api";
import { useDesign } from "../../lib/store";
import { marked, moreText, numberText, percentText, shareText } from "../../lib/words";
import { Bars } from "../../parts/Bars";
import { LevelSelect } from "../parts/LevelSelect";

export function Importance(): ReactNode {
  const design = useDesign();
  const [path, setPath] = useState("");
  const [found, setFound] = useState<Shapes["ImportanceList"] | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    get("/api/analysis/importance", { path })
      .then((one) => {
        setFound(one);
        setWrong("");
      })
      .catch((error: Error) => setWrong(error.message));
  }, [path, design?.state]);
  let sum = 0;
  return (
    <>
      <LevelSelect label="Of" value={path} set={setPath} />
      {wrong && (
        <div className="trouble" role="alert">
          {wrong}
        </div>
      )}
      {found && (
        <div className="stack">
          <section className="card">
            <h2>Pareto: share of the failures within {numberText(found.hours)} h of operation that hang on a part</h2>
            <p className="small quiet">In brackets: the share that it and those above it cause.</p>
            <Bars
              title="Criticality"
              names={["criticality"]}
              bars={found.parts.slice(0, 15).map((one) => {
                sum += one.barlow_proschan ?? 0;
                return { name: one.part, values: [one.criticality], words: `${shareText(one.criticality)} (${shareText(sum)})` };
              })}
            />
          </section>
          <section className="card scroll" tabIndex={0} role="region" aria-label="Importances">
            <table>
              <caption>
                It fails within that time with {marked(found.unknown, "failing", percentText(found.failure))}. Causes: share of all failures to come that its own failure brings about (Barlow–Proschan).
                {found.more > 0 && ` ${moreText(found.more)}.`} {found.refused}
                {found.unknown && ` ${found.unknown.sentence}.`}
              </caption>
              <thead>
                <tr>
                  {["Part", "Birnbaum", "Criticality", "Fussell–Vesely", "RAW", "RRW", "Improvement", "Causes"].map((one, i) => (
                    <th key={one} scope="col" className={i ? "number" : ""}>
                      {one}
                    </th>
                  ))}
                </tr>
              </thead>
              <tbody>
                {found.parts.map((one) => (
                  <tr key={one.part}>
                    <th scope="row">{one.part}</th>
                    <td className="number">{numberText(one.birnbaum)}</td>
                    <td className="number">{shareText(one.criticality)}</td>
                    <td className="number">{shareText(one.fussell_vesely)}</td>
                    <td className="number">{numberText(one.achievement)}</td>
                    <td className="number">{numberText(one.reduction)}</td>
                    <td className="number">{numberText(one.improvement)}</td>
                    <td className="number">{shareText(one.barlow_proschan)}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </section>
        </div>
      )}
    </>
  );
}
