// What is said of a new robot, kept while its page is left; its files lie in the service.
import { get, remove, send, type Shapes } from "../../lib/api";
import { sayError, Shared } from "../../lib/store";

export interface Said {
  answers: Record<string, string>;
  parts: Shapes["PartChange"][];
  modules: Record<string, string>;
  name: string;
}

export const said = new Shared<Said>({ answers: {}, parts: [], modules: {}, name: "" });
/** What the service has; null before it has answered. */
export const handed = new Shared<Shapes["NewRobot"] | null>(null);
/** The file that goes over now, and the share of it that has. */
export const going = new Shared<{ name: string; share: number } | null>(null);
/** Files that were refused, and why. */
export const refused = new Shared<string[]>([]);

let begun = false;

export async function load(): Promise<void> {
  try {
    const found = await get("/api/new");
    handed.set(found);
    if (!begun) said.set({ ...said.get(), answers: found.answers, parts: found.parts });
    begun = true;
  } catch (error) {
    sayError(error);
  }
}

export function change(next: Partial<Said>): void {
  said.set({ ...said.get(), ...next });
}

/** Files go over one after another. */
let turn: Promise<void> = Promise.resolve();

export function handIn(files: File[]): void {
  refused.set([]);
  for (const file of files) turn = turn.then(() => handInOne(file));
}

async function handInOne(file: File): Promise<void> {
  const room = handed.get()?.room ?? Infinity;
  try {
    if (file.size > room)
      throw new Error(`${file.name}: has ${(file.size / 1e9).toFixed(1)} GB, and ${(room / 1e9).toFixed(1)} GB may still come. It can stay where it is: robophm serve --replay FILE.`);
    going.set({ name: file.name, share: 0 });
    handed.set(await send("/api/new/files", file, { name: file.name }, (share) => going.set({ name: file.name, share })));
  } catch (error) {
    refused.set([...refused.get(), error instanceof Error ? error.message : String(error)]);
  }
  going.set(null);
}

export async function takeAway(name: string): Promise<void> {
  try {
    handed.set(await remove("/api/new/files/{name}", { name }));
  } catch (error) {
    sayError(error);
  }
}
