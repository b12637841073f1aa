// Parts that move: to another level, or elsewhere in its diagram.
import type { Operation } from "../../lib/api";
import { editWithUndo } from "../../lib/store";
import { levelOf, levelPlace, type Part } from "../../lib/tree";
import { lastStep } from "../../lib/words";

export interface Spot {
  beside: string[];
  before: boolean;
}

/** Where the parts are then; null where they could not be moved. */
export async function move(parts: Part[], level: string, spot: Spot | null): Promise<string[] | null> {
  const names = parts.map((one) => one.name);
  const coming = parts.filter((one) => levelOf(one.path) !== level);
  const operations: Operation[] = coming.map((one) => ({ op: "move", path: one.place, to: levelPlace(level) }));
  if (spot || coming.length < parts.length)
    operations.push({ op: "place", path: levelPlace(level), members: names, beside: spot?.beside ?? [], before: spot?.before ?? false });
  const where = spot ? `${spot.before ? "before" : "behind"} ${spot.beside[spot.before ? 0 : spot.beside.length - 1]}` : coming.length ? `to ${level ? lastStep(level) : "the robot"}` : "to the end";
  const done = await editWithUndo(operations, `Moved ${names.join(", ")} ${where}`);
  return done ? names.map((name) => (level ? `${level}/${name}` : name)) : null;
}
