// What all pages share: the design, preferences, toasts. Each is a value with listeners.
import { useSyncExternalStore } from "react";
import { type DesignState, get, type Operation, type Outside, post, put, Refused } from "./api";
import type { RateUnit } from "./words";

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
}

function stored(): Preferences {
  const plain: Preferences = { unit: "1/h", theme: "auto" };
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
  applyTheme();
}

export function applyTheme(): void {
  const { theme } = preferences.get();
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
}

export const useUnit = (): RateUnit => useShared(preferences).unit;

export const design = new Shared<DesignState | null>(null);
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

function write(ask: (revision: number) => Promise<DesignState>, retry: () => void): Promise<boolean> {
  return inTurn(async () => {
    const now = design.get();
    if (!now) return false;
    try {
      design.set(await ask(now.revision));
      return true;
    } catch (error) {
      if (error instanceof Refused && error.status === 409 && error.current) {
        design.set(error.current);
        say("Somebody else changed the design meanwhile. Theirs is shown; yours was not made.", "error", {
          label: "Make mine too",
          run: retry,
        });
      } else if (error instanceof Refused && error.outside) outside.set(error.outside);
      else sayError(error);
      return false;
    }
  });
}

export function edit(operations: Operation[], what: string): Promise<boolean> {
  return write(
    (revision) => post("/api/design/edits", { revision, operations, what: what.slice(0, 200) }),
    () => void edit(operations, what),
  );
}

export async function editWithUndo(operations: Operation[], what: string): Promise<boolean> {
  const done = await edit(operations, what);
  if (done) say(what, "plain", { label: "Undo", run: () => void undo() });
  return done;
}

export function replaceText(text: string, what: string): Promise<boolean> {
  return write(
    (revision) => put("/api/design/text", { revision, text, what }),
    () => void replaceText(text, what),
  );
}

export const undo = (): Promise<boolean> =>
  write((revision) => post("/api/design/undo", { revision }), () => void undo());

export const redo = (): Promise<boolean> =>
  write((revision) => post("/api/design/redo", { revision }), () => void redo());

/** ``over``: the digest of what was changed by hand and is to be written over. */
export async function save(over: string | null = null): Promise<void> {
  if (await write((revision) => post("/api/design/save", { revision, over }), () => void save())) say(`Saved ${design.get()?.file}`);
}

/** What the file holds now, in place of what is here. */
export async function take(): Promise<void> {
  if (await write((revision) => post("/api/design/take", { revision }), () => void take()))
    say(`${design.get()?.file} as it is now`, "plain", { label: "Undo", run: () => void undo() });
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
