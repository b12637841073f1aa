// What all pages share: the design, preferences, toasts. Each is a value with listeners.
import { useSyncExternalStore } from "react";
import { type DesignState, get, type Operation, type Outside, post, put, Refused, type Shapes } from "./api";
import { type RateUnit, sayLocalTimes } from "./words";

export class Shared<T> {
  private listeners = new Set<() => void>();
  constructor(private value: T) {}
  get = (): T => this.value;
  set(value: T): void {
    this.value = value;
    this.listeners.forEach((listener) => listener());
  }
  listen = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
}

export function useShared<T>(shared: Shared<T>): T {
  return useSyncExternalStore(shared.listen, shared.get);
}

export interface Toast {
  id: number;
  text: string;
  tone: "plain" | "error";
  action?: { label: string; run: () => void };
}

export const toasts = new Shared<Toast[]>([]);
let nextToast = 1;

export function say(text: string, tone: Toast["tone"] = "plain", action?: Toast["action"]): void {
  const toast = { id: nextToast++, text, tone, action };
  toasts.set([...toasts.get().slice(-3), toast]);
  setTimeout(() => dismiss(toast.id), tone === "error" ? 12000 : 7000);
}

export function dismiss(id: number): void {
  toasts.set(toasts.get().filter((one) => one.id !== id));
}

export function sayError(error: unknown): void {
  say(error instanceof Error ? error.message : String(error), "error");
}

export interface Preferences {
  unit: RateUnit;
  theme: "auto" | "light" | "dark";
  /** Of which clock moments are. */
  times: "utc" | "local";
  /** As whom alarms are acknowledged. */
  name: string;
  /** Whether alarms are told on the desktop. */
  notices: boolean;
}

function stored(): Preferences {
  const plain: Preferences = { unit: "1/h", theme: "auto", times: "utc", name: "", notices: false };
  try {
    return { ...plain, ...(JSON.parse(localStorage.getItem("robophm") ?? "{}") as Partial<Preferences>) };
  } catch {
    return plain;
  }
}

export const preferences = new Shared<Preferences>(stored());

export function prefer(change: Partial<Preferences>): void {
  const next = { ...preferences.get(), ...change };
  preferences.set(next);
  try {
    localStorage.setItem("robophm", JSON.stringify(next));
  } catch {
    /* a private window keeps nothing */
  }
  applyPreferences();
}

export function applyPreferences(): void {
  const { theme, times } = preferences.get();
  sayLocalTimes(times === "local");
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
}

export const useUnit = (): RateUnit => useShared(preferences).unit;

export const design = new Shared<DesignState | null>(null);
design.listen(() => {
  const now = design.get();
  if (!now || now.history === history) return;
  history = now.history;
  recall();
});
export const unreachable = new Shared<string>("");

/** Whatever changes the design takes turns: each edit is made of the revision that the answer before it gave. */
let turn: Promise<unknown> = Promise.resolve();

function inTurn<T>(work: () => Promise<T>): Promise<T> {
  const mine = turn.then(work);
  turn = mine.catch(() => undefined);
  return mine;
}

let asking: Promise<void> | null = null;

/** Ask for the design; whoever asks while that is under way waits for the same answer. */
export function refresh(): Promise<void> {
  asking ??= inTurn(async () => {
    try {
      design.set(await get("/api/design"));
      unreachable.set("");
    } catch (error) {
      unreachable.set(error instanceof Error ? error.message : String(error));
    } finally {
      asking = null;
    }
  });
  return asking;
}

/** The file was changed by hand while it was open here; null where it was not, or what is to be done has been said. */
export const outside = new Shared<Outside | null>(null);

/** What was edited in this browser, the latest last: undo takes back one's own edits, not those of others. */
interface Own {
  done: { edit: number; what: string }[];
  undone: { edit: number; what: string }[];
}

export const own = new Shared<Own>({ done: [], undone: [] });
const MOST_OWN = 500;
let history = -1;

const kept = (): string => `robophm ${location.pathname} ${history}`;

/** What this browser has edited before, in this history of the design's edits; other tabs of it are the same person. */
function recall(): void {
  try {
    own.set({ done: [], undone: [], ...(JSON.parse(localStorage.getItem(kept()) ?? "{}") as Partial<Own>) });
  } catch {
    own.set({ done: [], undone: [] });
  }
}

addEventListener("storage", (event) => event.key === kept() && recall());

function remember(next: Own): void {
  own.set(next);
  try {
    localStorage.setItem(kept(), JSON.stringify(next));
  } catch {
    /* a private window keeps nothing */
  }
}

/** An edit of one's own was made: what it was, by the state that it made. */
function made(before: DesignState, now: DesignState, what: string): void {
  if (now.state === before.state) return;
  remember({ done: [...own.get().done, { edit: now.state, what }].slice(-MOST_OWN), undone: [] });
}

type Then = (before: DesignState, now: DesignState) => void;

type Alike = (before: DesignState, now: DesignState) => boolean;

function write(ask: (revision: number) => Promise<DesignState>, retry: () => void, then?: Then, alike?: Alike): Promise<boolean> {
  return inTurn(() => attempt(ask, retry, then, alike));
}

/** How often to ask again while others keep editing. */
const TIMES = 20;

/** ``alike``: whether what others have made of the design meanwhile makes no difference to what is asked for. */
async function attempt(ask: (revision: number) => Promise<DesignState>, retry: () => void, then?: Then, alike?: Alike, left = TIMES): Promise<boolean> {
  const now = design.get();
  if (!now) return false;
  try {
    const next = await ask(now.revision);
    then?.(now, next);
    design.set(next);
    return true;
  } catch (error) {
    if (error instanceof Refused && error.status === 409 && error.current) {
      design.set(error.current);
      if (left > 0 && alike?.(now, error.current)) return attempt(ask, retry, then, alike, left - 1);
      say("Somebody else changed the design meanwhile. Theirs is shown; yours was not made.", "error", {
        label: "Make mine too",
        run: retry,
      });
    } else if (error instanceof Refused && error.outside) outside.set(error.outside);
    else sayError(error);
    return false;
  }
}

export function edit(operations: Operation[], what: string): Promise<boolean> {
  return write(
    (revision) => post("/api/design/edits", { revision, operations, what: what.slice(0, 200) }),
    () => void edit(operations, what),
    (before, now) => made(before, now, what),
    (before, now) => untouched(operations, before, now),
  );
}

/** Whether the places that values are put to, or deleted at, are as they were; of other edits nothing is assumed. */
function untouched(operations: Operation[], before: DesignState, now: DesignState): boolean {
  const at = (state: DesignState, path: string[]): string =>
    JSON.stringify(path.reduce<unknown>((value, key) => (value as Record<string, unknown> | undefined)?.[key], state.document)) ?? "";
  return operations.every((one) => (one.op === "put" || one.op === "delete") && at(before, one.path) === at(now, one.path));
}

export async function editWithUndo(operations: Operation[], what: string): Promise<boolean> {
  const done = await edit(operations, what);
  if (done) offerUndo(what);
  return done;
}

/** A message whose button takes back the edit that it speaks of, whatever was edited after it. */
function offerUndo(what: string): void {
  const latest = own.get().done.at(-1);
  if (latest) say(what, "plain", { label: "Undo", run: () => void undo(latest) });
}

/** ``of``: the revision whose text was edited, where that may not be the latest any more; ``retry``: how to go on then. */
export function replaceText(text: string, what: string, of?: number, retry = (): void => void replaceText(text, what)): Promise<boolean> {
  return write(
    (revision) => put("/api/design/text", { revision: of ?? revision, text, what }),
    retry,
    (before, now) => made(before, now, what),
  );
}

/** Make a draft of the robot the design, and save it. */
export function useDraft(asked: Omit<Shapes["UseAsked"], "revision">, what: string): Promise<boolean> {
  return write(
    (revision) => post("/api/new/use", { ...asked, revision }),
    () => void useDraft(asked, what),
    (before, now) => made(before, now, what),
  );
}

/** Open the example robot, and watch it drive. */
export function runExample(): Promise<boolean> {
  return write((revision) => post("/api/new/example", { revision }), () => void runExample(), (before, now) => made(before, now, "open the example robot"));
}

type One = Own["done"][number];
const without = (all: One[], one: One): One[] => all.filter((other) => other.edit !== one.edit);

/** Take back an edit of one's own, the latest unless another is said; what others have edited since stays. */
export function undo(one?: One): Promise<boolean> {
  return inTurn(async () => {
    const mine = one ?? own.get().done.at(-1);
    if (!mine) return undoOthers();
    const done = await attempt((revision) => post("/api/design/undo", { revision, edit: mine.edit }), () => void undo(mine), undefined, () => true);
    const { done: left, undone } = own.get();
    if (done) remember({ done: without(left, mine), undone: [...undone, mine] });
    return done;
  });
}

/** The latest edit of all was made elsewhere: it is taken back when that is asked for, and not by a key alone. */
function undoOthers(): boolean {
  const what = design.get()?.undo;
  if (what == null) return false;
  const run = (): void => void write((revision) => post("/api/design/undo", { revision, edit: null }), run);
  say(`Nothing that was edited in this browser is left to undo. The latest edit, made elsewhere: ${what}`, "plain", { label: "Undo that", run });
  return false;
}

/** Do again what was taken back here last; where that is nothing, what was taken back elsewhere. */
export function redo(): Promise<boolean> {
  return inTurn(async () => {
    const mine = own.get().undone.at(-1);
    if (!mine && design.get()?.redo == null) return false;
    const ask = (revision: number): Promise<DesignState> => post("/api/design/redo", { revision, edit: mine?.edit ?? null });
    let again = mine;
    const then: Then = (_, now) => (again = mine && { edit: now.state, what: mine.what });
    const done = await attempt(ask, () => void redo(), then, () => mine !== undefined);
    const { done: before, undone } = own.get();
    if (done && mine && again) remember({ done: [...before, again], undone: without(undone, mine) });
    return done;
  });
}

/** ``over``: the digest of what was changed by hand and is to be written over. */
export async function save(over: string | null = null): Promise<void> {
  if (await write((revision) => post("/api/design/save", { revision, over }), () => void save())) say(`Saved ${design.get()?.file}`);
}

/** What the file holds now, in place of what is here. */
export async function take(): Promise<void> {
  const what = "changed outside";
  if (await write((revision) => post("/api/design/take", { revision }), () => void take(), (before, now) => made(before, now, what)))
    offerUndo(`${design.get()?.file} as it is now`);
}

export const useDesign = (): DesignState | null => useShared(design);

/** The page that is open, and what follows it in the address: #/design/Power/Board. */
function here(): { page: string; rest: string } {
  let said = location.hash;
  try {
    said = decodeURIComponent(said);
  } catch {
    // an address that a person typed: "50%" is meant as it stands
  }
  const [, page = "", ...rest] = said.split("/");
  return { page: page || "overview", rest: rest.join("/") };
}

export const route = new Shared(here());
addEventListener("hashchange", () => route.set(here()));

export function go(page: string, rest = ""): void {
  location.hash = `#/${page}${rest ? `/${encodeURIComponent(rest).replaceAll("%2F", "/")}` : ""}`;
}
