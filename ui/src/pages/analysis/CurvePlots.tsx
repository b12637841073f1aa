import { type ReactNode, useMemo } from "react";
import type { Shapes } from "../../lib/api";
import { useUnit } from "../../lib/store";
import { durationText, marked, oddsText, percentText, RATE_UNITS, rateText } from "../../lib/words";
import { type Curve, Plot } from "../../parts/Plot";

export type Curves = Shapes["Curves"];

export function CurvePlots({ found, other, otherName, log }: { found: Curves; other: Curves | null; otherName: string; log: boolean }): ReactNode {
  const unit = useUnit();
  const left = found.unknown ?? other?.unknown;
  const factor = RATE_UNITS[unit].factor;
  const of = (key: "reliability" | "unreliability" | "hazard_rate" | "density", scale = 1): Curve[] => {
    const pick = (one: Curves, more: string, color: number): Curve[] =>
      (["nominal", "sensor_based"] as const).map((view, i) => ({
        name: `${view.replace("_", "-")}${more}`,
        x: one.hours,
        y: one[view][key].map((value) => (value == null ? null : value * scale)),
        dashed: i === 1,
        color: color + i,
      }));
    return [...pick(found, "", 0), ...(other ? pick(other, `, ${otherName}`, 2) : [])];
  };
  const survival = useMemo(() => of(log ? "unreliability" : "reliability"), [found, other, log]);
  const hazard = useMemo(() => of("hazard_rate", factor), [found, other, factor]);
  const density = useMemo(() => of("density", factor), [found, other, factor]);
  const views = [["nominal", found.nominal], ["sensor-based", found.sensor_based], ...(other ? [[`nominal, ${otherName}`, other.nominal], [`sensor-based, ${otherName}`, other.sensor_based]] : [])] as [string, Shapes["CurveOf"]][];
  return (
    <div className="stack">
      <div className="card scroll" tabIndex={0} role="region" aria-label="In figures">
        <table>
          {left && <caption>{left.sentence}.</caption>}
          <thead>
            <tr>
              <th scope="col">In figures</th>
              <th scope="col" className="number">λ now</th>
              <th scope="col" className="number">R at the horizon</th>
              <th scope="col" className="number">Median remaining life</th>
              <th scope="col" className="number">Mean</th>
              <th scope="col" className="number">90 % between</th>
            </tr>
          </thead>
          <tbody>
            {views.map(([name, one]) => (
              <tr key={name}>
                <th scope="row">{name}</th>
                <td className="number">{marked(left, "hazard_rate", rateText(one.hazard_rate_now, unit))}</td>
                <td className="number">
                  {left && "≤ "}
                  {percentText(one.reliability.at(-1), one.unreliability.at(-1))} {oddsText(one.unreliability.at(-1)) && `(fails ${oddsText(one.unreliability.at(-1))})`}
                </td>
                <td className="number">{marked(left, "ahead", durationText(one.remaining_life.median))}</td>
                <td className="number">{marked(left, "ahead", durationText(one.remaining_life.mean))}</td>
                <td className="number">
                  {durationText(one.remaining_life.early)} and {durationText(one.remaining_life.late)}
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <div className="two">
        <Plot title={log ? "Probability of having failed" : "Reliability"} curves={survival} xLabel="hours of operation from now" yLabel={log ? "1 − R" : "R, survival since new"} log={log} />
        <Plot title="Hazard rate of survivors" curves={hazard} xLabel="hours of operation from now" yLabel={`λ = f/R [${RATE_UNITS[unit].axis}]`} />
        <Plot title="Failure density" curves={density} xLabel="hours of operation from now" yLabel={`f [${RATE_UNITS[unit].axis}]`} />
      </div>
    </div>
  );
}
