// Numbers as people read them; the same words as the command line and the reports use.

export type RateUnit = "1/h" | "FIT" | "FPMH" | "MTBF";

/** How rates are written; an axis of a plot has the rate itself, also where texts say one in so many hours. */
export const RATE_UNITS: Record<RateUnit, { factor: number; name: string; axis: string; words: string }> = {
  "1/h": { factor: 1, name: "/h", axis: "1/h", words: "1/h: per hour" },
  FIT: { factor: 1e9, name: "FIT", axis: "FIT", words: "FIT: per 10⁹ hours" },
  FPMH: { factor: 1e6, name: "FPMH", axis: "FPMH", words: "FPMH: per 10⁶ hours" },
  MTBF: { factor: 1, name: "/h", axis: "1/h", words: "MTBF: one in so many hours" },
};

type Value = number | null | undefined;

export function numberText(value: Value | "Infinity", digits = 4): string {
  if (value == null || Number.isNaN(value)) return "–";
  if (value === "Infinity") return "∞";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "-∞";
  const rounded = Number(value.toExponential(digits - 1));
  if (rounded === 0) return "0";
  const size = Math.abs(rounded);
  if (size >= 1e-3 && size < 1e6) {
    const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return rounded.toLocaleString("en-US", { maximumFractionDigits: decimals });
  }
  const [mantissa = "", exponent = "0"] = rounded.toExponential(digits - 1).split("e");
  return `${mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa}e${Number(exponent)}`;
}

export function rateText(rate: Value, unit: RateUnit): string {
  if (rate == null) return "–";
  if (unit === "MTBF" && rate > 0) return `1 in ${numberText(1 / rate)} h`;
  const { factor, name } = RATE_UNITS[unit];
  return `${numberText(rate * factor)} ${name}`;
}

type Figure = "hazard_rate" | "reliability" | "ahead" | "failing";
export type Unknown = Record<Figure, string> | null | undefined;

const MARKS: Record<string, string> = { "at least": "≥ ", "at most": "≤ ", "if they never fail": "? " };

/** A figure of what has parts of unknown rate in it: "≥ 3e-6 /h"; "unknown" where that would say nothing. */
export function marked(unknown: Unknown, which: Figure, text: string): string {
  if (!unknown || text === "–" || text === "…") return text;
  return text.startsWith("0 ") || text === "for ever" ? "unknown" : `${MARKS[unknown[which]] ?? ""}${text}`;
}

/** Probabilities in percent; ``beside`` is the failure of another one that stands beside it: what differs must read so. */
export function percentText(p: Value, failure?: Value, beside?: Value): string {
  if (p == null) return "–";
  const q = failure ?? 1 - p;
  if (q <= 0 || q > 0.1) return `${numberText(100 * p)} %`;
  if (q < 1e-12) return "> 99.9999999999 %";
  const decimals = (one: number): number => Math.max(2, Math.ceil(-2 - Math.log10(one)));
  const text = (one: number, more = 0): string => (100 - 100 * one).toFixed(Math.min(decimals(one) + more, 14)).replace(/\.?0+$/, "");
  let more = 0;
  if (beside != null && beside >= 1e-12 && beside <= 0.1) while (more < 2 && text(q, more) === text(beside, more)) more++;
  return `${text(q, more)} %`;
}

/** A share in percent to three digits; one below 1 as ``percentText``, where three digits were all. */
export function shareText(share: Value): string {
  const short = share == null ? "–" : `${numberText(100 * share, 3)} %`;
  return short === "100 %" && share! < 1 ? percentText(share) : short;
}

/** "1 in 4,700"; "" where a percentage says more. */
export function oddsText(failure: Value): string {
  if (failure == null || !(failure > 0 && failure <= 0.1)) return "";
  const odds = Number((1 / failure).toPrecision(2));
  return `1 in ${odds < 1e12 ? odds.toLocaleString("en-US") : numberText(odds)}`;
}

const SPANS: [string, number, number][] = [
  ["s", 1 / 3600, 60],
  ["min", 1 / 60, 60],
  ["h", 1, 48],
  ["days", 24, 730],
  ["years", 8766, Infinity],
];

/** Of hours. */
export function durationText(hours: Value): string {
  if (hours == null) return "for ever";
  if (!Number.isFinite(hours)) return numberText(hours);
  if (hours === 0) return "0 h";
  const [unit, length] = SPANS.find(([, n, limit]) => Number((Math.abs(hours) / n).toPrecision(3)) < limit) ?? SPANS[4]!;
  return `${numberText(hours / length, 3)} ${unit}`;
}

/** A unit as people write it: the design says degC, which any keyboard has. */
export function unitText(unit: string | null | undefined): string {
  return (unit ?? "").replace("deg", "°");
}

export function secondsText(seconds: Value): string {
  return seconds == null ? "never heard" : seconds < 0.5 ? "now" : `${durationText(seconds / 3600)} ago`;
}

let local = false;

/** Have moments in the time of the browser's place, or in UTC. */
export function sayLocalTimes(wanted: boolean): void {
  local = wanted;
}

/** How far the browser's place is ahead of UTC at a time [s since the epoch], in seconds; 0 where moments are in UTC. */
export function ahead(seconds: number): number {
  return local ? -60 * new Date(seconds * 1000).getTimezoneOffset() : 0;
}

/** What moments are in: "UTC", "UTC+2", "UTC−3:30". */
export function zoneText(seconds: number): string {
  const minutes = Math.round(Math.abs(ahead(seconds)) / 60);
  if (!minutes) return "UTC";
  return `UTC${ahead(seconds) < 0 ? "−" : "+"}${Math.floor(minutes / 60)}${minutes % 60 ? `:${String(minutes % 60).padStart(2, "0")}` : ""}`;
}

export function momentText(seconds: Value): string {
  if (seconds == null) return "–";
  return `${new Date((seconds + ahead(seconds)) * 1000).toISOString().replace("T", " ").slice(0, 19)} ${zoneText(seconds)}`;
}

export function lastStep(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1);
}

/** "99.98 % (fails 1 in 4,700)"; "≤ 99.98 % …" where parts of unknown rate are left out. */
export function chanceWords(chance: { probability: number | null; failure: number | null }, unknown: Unknown): string {
  const odds = oddsText(chance.failure);
  return marked(unknown, "ahead", percentText(chance.probability, chance.failure) + (odds ? ` (fails ${odds})` : ""));
}

/** "1 more is not shown", "3 more are not shown". */
export function moreText(count: number): string {
  return `${count.toLocaleString("en-US")} more ${count === 1 ? "is" : "are"} not shown`;
}
