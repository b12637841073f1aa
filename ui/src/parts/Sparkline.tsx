// A figure's course as a line without axes; where nothing was known there is none.
import type { ReactNode } from "react";
import type { Card, Trends } from "../lib/trends";
import { durationText } from "../lib/words";

const [WIDE, HIGH] = [100, 24];
const DIGITS = 1e-6; // figures are kept to seven

export function Sparkline({ trends, card, text }: { trends: Trends; card: Card; text: (value: number) => string }): ReactNode {
  const { times, breaks } = trends;
  const course = trends.figures[card]?.course ?? [];
  const known = course.filter((one) => one != null);
  const [first, last] = [times[0], times.at(-1)];
  if (known.length < 2 || first == null || last == null) return null;
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const flat = high - low <= DIGITS * Math.max(Math.abs(low), Math.abs(high));
  const complement = card === "reliability" || card === "completion";
  const height = (value: number): number => {
    const share = flat ? 0.5 : (value - low) / (high - low);
    return 2 + (HIGH - 4) * (complement ? share : 1 - share);
  };
  const broken = new Set(breaks);
  const path = course.map((value, i) => {
    if (value == null) return "";
    const at = `${((WIDE * (times[i]! - first)) / (last - first)).toFixed(2)} ${height(value).toFixed(2)}`;
    return i && course[i - 1] != null && !broken.has(i) ? `L${at}` : `M${at}h0`; // by itself, a dot
  });
  const span = durationText((last - first) / 3600);
  const ends = [text(low), text(high)];
  if (complement) ends.reverse();
  return (
    <div className="sparkline">
      <svg viewBox={`0 0 ${WIDE} ${HIGH}`} preserveAspectRatio="none" role="img" aria-label={`Over ${span} between ${ends.join(" and ")}`}>
        <path d={path.join("")} />
      </svg>
      <span className="quiet small">{span}</span>
    </div>
  );
}
