// The design's document as a tree of parts, whether it is a valid design or not.
import type { DesignState, Operation } from "./api";

export type Values = Record<string, unknown>;

export interface Part {
  kind: "robot" | "module" | "component";
  name: string;
  /** Names from the robot down, joined by "/"; "" is the robot. */
  path: string;
  /** Keys in the design file. */
  place: string[];
  values: Values;
  parts: Part[];
}

export function isValues(value: unknown): value is Values {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function inside(values: Values, key: string): [string, Values][] {
  const found = values[key];
  return isValues(found) ? Object.entries(found).map(([name, one]) => [name, isValues(one) ? one : {}]) : [];
}

function level(kind: Part["kind"], name: string, path: string, place: string[], values: Values): Part {
  const below = (child: string): string => (path ? `${path}/${child}` : child);
  const parts = [
    ...inside(values, "modules").map(([child, one]) => level("module", child, below(child), [...place, "modules", child], one)),
    ...inside(values, "components").map(
      ([child, one]): Part => ({ kind: "component", name: child, path: below(child), place: [...place, "components", child], values: one, parts: [] }),
    ),
  ];
  return { kind, name, path, place, values, parts };
}

const kept = new WeakMap<DesignState, Part>();

export function treeOf(design: DesignState): Part {
  let tree = kept.get(design);
  if (!tree) {
    tree = level("robot", design.name, "", [], design.document as Values);
    kept.set(design, tree);
  }
  return tree;
}

/** What says how often a part fails: one of these, or an entry of the library of parts. */
export const FIGURES = ["rate", "mtbf", "mttf", "l10", "b10", "hazard"];

/** By what its rate is, where it states none itself: "l10 20000 h", "lidar_2d of the library". */
export function insteadOfRate(values: Values): string {
  const key = FIGURES.find((one) => values[one] !== undefined);
  if (key === "hazard" && isValues(values.hazard)) return values.hazard.model ? String(values.hazard.model) : "a formula";
  if (key) return key === "rate" ? "" : `${key} ${String(values[key])}`;
  return values.part === undefined ? "" : `${String(values.part)} of the library`;
}

export function* everyPart(part: Part): Generator<Part> {
  yield part;
  for (const one of part.parts) yield* everyPart(one);
}

/** Whether no robot has been designed yet: there is no part. Of what cannot be read nothing is known. */
export function isEmpty(design: DesignState): boolean {
  return Object.keys(design.document).length > 0 && ![...everyPart(treeOf(design))].some((part) => part.kind === "component");
}

export function findPart(design: DesignState, path: string): Part | undefined {
  let here: Part | undefined = treeOf(design);
  if (!path) return here;
  let left = path;
  while (here && left) {
    const next: Part | undefined = here.parts.find((one) => left === one.name || left.startsWith(`${one.name}/`));
    left = next ? left.slice(next.name.length + 1) : left;
    here = next;
  }
  return here;
}

export function levelOf(path: string): string {
  return path.includes("/") ? path.slice(0, path.lastIndexOf("/")) : "";
}

export function freeName(part: Part, wanted: string): string {
  const taken = new Set(part.parts.map((one) => one.name));
  if (!taken.has(wanted)) return wanted;
  let number = 2;
  while (taken.has(`${wanted} ${number}`)) number += 1;
  return `${wanted} ${number}`;
}

/** Put a value, or take it away where there is none. */
export function change(part: Part, key: string[], value: unknown): Operation[] {
  const path = [...part.place, ...key];
  if (value === undefined || value === "" || value === null) {
    let here: unknown = part.values;
    for (const step of key) here = isValues(here) ? here[step] : undefined;
    return here === undefined ? [] : [{ op: "delete", path }];
  }
  return [{ op: "put", path, value }];
}

export function partOfPlace(place: string[]): string {
  const names: string[] = [];
  for (let i = 0; i + 1 < place.length && ["modules", "components"].includes(place[i]!); i += 2) names.push(place[i + 1]!);
  return names.join("/");
}

export function levelPlace(level: string): string[] {
  return level ? level.split("/").flatMap((name) => ["modules", name]) : [];
}
