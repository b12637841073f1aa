import type { ReactNode } from "react";
import type { Health } from "../../lib/api";
import { useLimits } from "../../lib/alarms";
import { useUnit } from "../../lib/store";
import { type Card, trendRows, type Trends, useTrends } from "../../lib/trends";
import { chanceWords, durationText, marked, numberText, oddsText, percentText, rateText } from "../../lib/words";
import { Sparkline } from "../../parts/Sparkline";

/** The robot's figures, each with its limit, its course and its change. */
export function Cards({ health }: { health: Health }): ReactNode {
  const unit = useUnit();
  const limits = useLimits();
  const trends = useTrends();
  const robot = health.subjects[0];
  if (!robot) return null;
  const [nominal, lived] = [robot.nominal, robot.sensor_based];
  const tone = health.state === "idle" ? "" : health.state;
  const life = lived.remaining_life;
  const left = robot.unknown;
  const limit = (figure: string, text: (value: number) => string): [string, string][] =>
    limits
      .filter((one) => one.series === `${figure}.sensor_based:`)
      .map((one) => [one.severity === "error" ? "limit" : "warning", `at ${figure === "hazard_rate" ? "most" : "least"} ${text(one.limit)}`]);
  return (
    <div className="cards">
      <Figure trends={trends} card="reliability" text={(failed) => marked(left, "reliability", percentText(1 - failed, failed))} tone={tone} name="Reliability R(t)" value={marked(left, "reliability", percentText(lived.reliability, lived.unreliability, nominal.unreliability))} rows={[
        ["nominal", marked(left, "reliability", percentText(nominal.reliability, nominal.unreliability, lived.unreliability))],
        ["failed since new", lived.unreliability === 0 ? "no exposure yet" : oddsText(lived.unreliability) || percentText(lived.unreliability, lived.reliability)],
        ...limit("reliability", percentText),
      ]} />
      <Figure trends={trends} card="hazard_rate" text={(value) => marked(left, "hazard_rate", rateText(value, unit))} tone={tone} name="Hazard rate λ now" value={marked(left, "hazard_rate", rateText(lived.hazard_rate, unit))} rows={[
        ["nominal", marked(left, "hazard_rate", rateText(nominal.hazard_rate, unit))],
        ["", "per hour of operation, given that it works"],
        ...limit("hazard_rate", (value) => rateText(value, unit)),
      ]} />
      <Figure trends={trends} card="remaining_life" text={(value) => marked(left, "ahead", durationText(value))} tone={tone} name="Remaining life, median" value={life ? marked(left, "ahead", durationText(life.median)) : "…"} rows={[
        ["nominal", nominal.remaining_life ? marked(left, "ahead", durationText(nominal.remaining_life.median)) : "…"],
        ["90 % between", life ? marked(left, "ahead", `${durationText(life.early)} and ${durationText(life.late)}`) : "…"],
        ...(health.unsure ? [["with rates unsure", marked(left, "ahead", `${durationText(health.unsure[0])} and ${durationText(health.unsure[1])}`)] as [string, string]] : []),
        ...(health.survival != null ? [[`with ${percentText(health.survival)}`, life ? marked(left, "ahead", durationText(life.survived)) : "…"] as [string, string]] : []),
        ...limit("remaining_life", durationText),
      ]} />
      {health.task && (
        <Figure trends={trends} card="completion" text={(failed) => marked(left, "ahead", percentText(1 - failed, failed))} tone={tone} name={`Task of ${health.task.distance ? `${numberText(health.task.distance)} m in ` : ""}${durationText(health.task.duration)}, completed`} value={marked(left, "ahead", percentText(lived.completion, lived.completion_failure, nominal.completion_failure))} rows={[
          ["nominal", chanceWords({ probability: nominal.completion ?? null, failure: nominal.completion_failure ?? null }, left)],
          [left?.ahead === "at most" ? "fails at least" : "fails", oddsText(lived.completion_failure) || "–"],
          ...limit("completion", percentText),
        ]} />
      )}
    </div>
  );
}

interface FigureProps {
  name: string;
  value: string;
  rows: [string, string][];
  tone: string;
  trends: Trends | null;
  card: Card;
  /** What is said of a value of its course. */
  text: (value: number) => string;
}

function Figure({ name, value, rows, tone, trends, card, text }: FigureProps): ReactNode {
  return (
    <section className={`card figure ${tone}`}>
      <h2>{name}</h2>
      <div className="value">{value}</div>
      {trends && <Sparkline trends={trends} card={card} text={text} />}
      <dl>
        {[...rows, ...trendRows(trends, card)].map(([key, says]) => (
          <div key={key} style={{ display: "contents" }}>
            <dt>{key}</dt>
            <dd>{says}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
