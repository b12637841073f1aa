// Where a dragged box would go.
import type { Shapes } from "../../../lib/api";
import type { Point } from "../../../lib/network";
import { levelOf, type Part } from "../../../lib/tree";
import { lastStep } from "../../../lib/words";
import type { Spot } from "../moving";

export interface Target {
  /** Of the node that is dropped on; "" is the ground or another list. */
  id: string;
  how: "before" | "behind" | "into" | "end";
  words: string;
  level: string;
  spot: Spot | null;
}

export interface Drag {
  id: string;
  at: Point;
  target: Target | null;
}

const GATE = 34;
const NEAR = 12; // beyond a box, and still it

export function stem(part: string): string {
  return part.replace(/\[\d+\]$/, "");
}

function pointer(event: MouseEvent | TouchEvent | React.MouseEvent | React.TouchEvent): Point {
  const touch = "changedTouches" in event ? event.changedTouches[0] : undefined;
  const { clientX: x, clientY: y } = touch ?? (event as MouseEvent);
  return { x, y };
}

const inside = (p: Point, x: number, y: number, width: number, height: number): boolean =>
  p.x >= x - NEAR && p.x <= x + width + NEAR && p.y >= y - NEAR && p.y <= y + height + NEAR;

/** What would become of the parts if they were dropped here; null: nothing. */
export function targetAt(
  event: MouseEvent | TouchEvent | React.MouseEvent | React.TouchEvent, toFlow: (at: Point) => Point,
  drawing: Shapes["Drawing"] | null, level: string, parts: Part[],
): Target | null {
  if (!drawing || !parts.length) return null;
  const screen = pointer(event);
  const over = document.elementFromPoint(screen.x, screen.y)?.closest<HTMLElement>("[data-level]")?.dataset.level;
  if (over != null) return over === level || parts.some((one) => `${over}/`.startsWith(`${one.path}/`)) ? null : into("", over);
  const at = toFlow(screen);
  const mine = new Set(parts.map((one) => one.path));
  const own = (part: string | null): boolean => part != null && mine.has(stem(part));
  if (drawing.boxes.some((box) => own(box.part) && inside(at, box.x, box.y, box.width, box.height))) return null;
  const i = drawing.boxes.findIndex((box) => !own(box.part) && inside(at, box.x, box.y, box.width, box.height));
  if (i >= 0) {
    const box = drawing.boxes[i]!;
    const path = box.part ? stem(box.part) : "";
    if (!path || levelOf(path) !== level) return null;
    const share = (at.x - box.x) / box.width;
    if (box.kind === "module" && share > 0.25 && share < 0.75) return into(`box ${i}`, path);
    const before = share < 0.5;
    return { id: `box ${i}`, how: before ? "before" : "behind", words: `${before ? "before" : "behind"} ${lastStep(path)}, in its group`, level, spot: { beside: [lastStep(path)], before } };
  }
  const n = drawing.gates.findIndex((gate) => inside(at, gate.x, gate.y - GATE / 2, gate.width, GATE));
  if (n >= 0) {
    const gate = drawing.gates[n]!;
    const beside = [...new Set(gate.parts.map(stem))].filter((path) => levelOf(path) === level && !mine.has(path)).map(lastStep);
    return beside.length ? { id: `gate ${n}`, how: "into", words: `into the group ${gate.text}`, level, spot: { beside, before: false } } : null;
  }
  return { id: "", how: "end", words: "at the end, in series", level, spot: null };
}

function into(id: string, level: string): Target {
  return { id, how: "into", words: level ? `into ${lastStep(level)}` : "to the robot's own level", level, spot: null };
}

export function dropped(target: Target, parts: Part[], level: string, move: (parts: Part[], level: string, spot: Spot | null) => Promise<string[] | null>): Promise<string[] | null> {
  return move(parts, target.level, target.level === level ? (target.spot ?? { beside: [], before: false }) : null);
}
