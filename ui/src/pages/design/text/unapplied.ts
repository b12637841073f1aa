// What was written in the text of the design and not applied yet: kept by the tab over a reload, told of before the tab is closed.

export interface Unapplied {
  text: string;
  /** The design's text of which it was made, and the revision that had it. */
  base: string;
  revision: number;
}

/** By the history of edits that it belongs to; a tab may show several designs at one address, one after the other. */
const left = new Map<number, Unapplied>();

const kept = (history: number): string => `robophm text ${location.pathname} ${history}`;

export function unapplied(history: number): Unapplied | null {
  try {
    return left.get(history) ?? (JSON.parse(sessionStorage.getItem(kept(history)) ?? "null") as Unapplied | null);
  } catch {
    return null;
  }
}

export function keep(history: number, what: Unapplied | null): void {
  if (what) left.set(history, what);
  else left.delete(history);
  try {
    if (what) sessionStorage.setItem(kept(history), JSON.stringify(what));
    else sessionStorage.removeItem(kept(history));
  } catch {
    /* a private window, or too long a text: the browser warns before it is lost */
  }
}

addEventListener("beforeunload", (event) => left.size > 0 && event.preventDefault());
