// Where the marks of an axis stand, and what they say; moments are in UTC or local, as everywhere on the page.
import { ahead } from "./words";

/** Steps between the marks of an axis of time [s]: those of clocks and calendars. */
export const TIME_STEPS = [
  1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400, 172800, 604800, 1209600, 2592000, 7776000, 31536000,
];
const DAY = 86400;

const format = (shown: Intl.DateTimeFormatOptions): Intl.DateTimeFormat => new Intl.DateTimeFormat("en-GB", { ...shown, timeZone: "UTC" });
const clock = format({ hour: "2-digit", minute: "2-digit", second: "2-digit" });
const hour = format({ hour: "2-digit", minute: "2-digit" });
const day = format({ day: "numeric", month: "short" });
const year = format({ day: "numeric", month: "short", year: "numeric" });

/** A mark at a time [s since the epoch], one of marks that are a step apart. */
export function timeText(seconds: number, step: number): string {
  const here = seconds + ahead(seconds);
  const shown = step >= 300 * DAY ? year : step >= DAY || here % DAY === 0 ? day : step >= 60 ? hour : clock;
  return shown.format(here * 1000);
}

/** Marks of an axis of time, at most so many, with what they say. */
export function timeTicks(low: number, high: number, most: number): { at: number; text: string }[] {
  const step = TIME_STEPS.find((one) => (high - low) / one <= most) ?? TIME_STEPS.at(-1)!;
  return tickTimes(low, high, step).slice(0, most + 1).map((at) => ({ at, text: timeText(at, step) }));
}

/** Times between two that are whole steps of the clock that is shown. */
export function tickTimes(low: number, high: number, step: number): number[] {
  const found = [];
  const here = ahead(low);
  for (let at = Math.ceil((low + here) / step) * step - here; at <= high; at += step) found.push(at);
  return found;
}
