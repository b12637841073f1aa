// Networks of a design: nodes and what joins them, as the design file writes them, and where they are drawn.
import { isValues, type Values } from "./tree";

type Named = string[];
interface Said {
  between?: [string, string];
  from?: string;
  to?: string;
  through?: unknown;
}

export interface Network extends Values {
  from: string;
  to: string;
  links: (Named | Said)[];
  junctions?: string[];
}

/** One link; several come of a chain of names. */
export interface Join {
  start: string;
  end: string;
  oneWay: boolean;
  /** What on it may fail, as a diagram. */
  through?: unknown;
  /** Which of the links that are written, and which of its chain. */
  link: number;
  step: number;
}

/** The networks in a level's diagram, and where they stand in it. */
export function networksOf(diagram: unknown, place: string[] = ["diagram"]): { place: string[]; network: Network }[] {
  if (!isValues(diagram)) return [];
  const network = diagram.network as Network | undefined;
  if (isValues(network) && Array.isArray(network.links)) return [{ place: [...place, "network"], network }];
  return Object.entries(diagram).flatMap(([kind, inner]) => {
    const [list, at] = isValues(inner) ? [inner.of, [kind, "of"]] : [inner, [kind]];
    return Array.isArray(list) ? list.flatMap((one, i) => networksOf(one, [...place, ...at, String(i)])) : [];
  });
}

export function joinsOf(network: Network): Join[] {
  return network.links.flatMap((said, link): Join[] => {
    if (Array.isArray(said)) return said.slice(1).map((end, step) => ({ start: said[step]!, end, oneWay: false, link, step }));
    const [start, end] = said.between ?? [said.from ?? "", said.to ?? ""];
    return [{ start, end, oneWay: !said.between, through: said.through, link, step: 0 }];
  });
}

/** The start first, the end last. */
export function nodesOf(network: Network): string[] {
  const names = new Set([network.from, ...joinsOf(network).flatMap((one) => [one.start, one.end])]);
  names.delete(network.to);
  return [...names, network.to];
}

function written({ start, end, oneWay, through }: Pick<Join, "start" | "end" | "oneWay" | "through">): Named | Said {
  if (!oneWay && through == null) return [start, end];
  return { ...(oneWay ? { from: start, to: end } : { between: [start, end] }), ...(through == null ? {} : { through }) };
}

/** The network with something else in a link's place; the rest of its chain stays. */
function replaced(network: Network, join: Join, instead: (Named | Said)[]): Network {
  const links = network.links.flatMap((said, i) => {
    if (i !== join.link) return [said];
    if (!Array.isArray(said)) return instead;
    return [said.slice(0, join.step + 1), ...instead, said.slice(join.step + 1)].filter((one) => !Array.isArray(one) || one.length > 1);
  });
  return { ...network, links };
}

export const withLink = (network: Network, start: string, end: string): Network => ({ ...network, links: [...network.links, [start, end]] });
export const withoutLink = (network: Network, join: Join): Network => replaced(network, join, []);
export const withOther = (network: Network, join: Join, other: Partial<Join>): Network => replaced(network, join, [written({ ...join, ...other })]);

/** A part, or a junction, between two nodes; in the place of their link where there is one. */
export function withNode(network: Network, name: string, junction: boolean, start: string, end: string): Network {
  const old = joinsOf(network).find((one) => one.start === start && one.end === end && !one.oneWay && one.through == null);
  const links: Named[] = [[start, name, end]];
  const next = old ? replaced(network, old, links) : { ...network, links: [...network.links, ...links] };
  return junction ? { ...next, junctions: [...(network.junctions ?? []), name] } : next;
}

export function withoutNode(network: Network, name: string): Network {
  const links = network.links.flatMap((said): (Named | Said)[] => {
    if (!Array.isArray(said)) return [said.from, said.to, ...(said.between ?? [])].includes(name) ? [] : [said];
    const pieces: Named[] = [[]];
    for (const one of said) {
      if (one === name) pieces.push([]);
      else pieces[pieces.length - 1]!.push(one);
    }
    return pieces.filter((piece) => piece.length > 1);
  });
  const { junctions, ...rest } = network;
  const left = (junctions ?? []).filter((one) => one !== name);
  return { ...rest, links, ...(left.length ? { junctions: left } : {}) } as Network;
}

export interface Point {
  x: number;
  y: number;
}

export const WIDE = 150;
export const HIGH = 48;
const COLUMN = 230;
const ROW = 96;

/** Centres of the nodes, in columns by how many links they are from the start; the end stands last. */
export function layout(network: Network): Map<string, Point> {
  const near = new Map<string, string[]>(nodesOf(network).map((name) => [name, []]));
  for (const { start, end } of joinsOf(network)) {
    near.get(start)?.push(end);
    near.get(end)?.push(start);
  }
  const column = new Map([[network.from, 0]]);
  for (const name of column.keys()) {
    if (name === network.to) continue; // nothing is reached through the end
    for (const other of near.get(name) ?? []) if (!column.has(other)) column.set(other, column.get(name)! + 1);
  }
  const last = Math.max(1, ...[...column].filter(([name]) => name !== network.to).map(([, at]) => at + 1));
  column.set(network.to, last);
  const columns: string[][] = Array.from({ length: last + 1 }, () => []);
  for (const name of near.keys()) columns[column.get(name) ?? 1]!.push(name);
  const height = new Map<string, number>();
  const settle = (names: string[]): void => names.forEach((name, i) => height.set(name, i - (names.length - 1) / 2));
  columns.forEach(settle);
  for (let sweep = 0; sweep < 6; sweep++)
    for (const names of sweep % 2 ? [...columns].reverse() : columns) {
      const middle = (name: string): number => {
        const beside = near.get(name)!.filter((other) => column.get(other) !== column.get(name));
        return beside.length ? beside.reduce((sum, other) => sum + height.get(other)!, 0) / beside.length : height.get(name)!;
      };
      const wanted = new Map(names.map((name) => [name, middle(name)]));
      names.sort((a, b) => wanted.get(a)! - wanted.get(b)!);
      settle(names);
    }
  return new Map([...near.keys()].map((name) => [name, { x: COLUMN * (column.get(name) ?? 1), y: ROW * height.get(name)! }]));
}

/** Where the line from a node's centre towards a point leaves its box. */
function leaves({ x, y }: Point, to: Point): Point {
  const [dx, dy] = [to.x - x, to.y - y];
  const share = Math.min(1, Math.min(dx ? (WIDE / 2 + 4) / Math.abs(dx) : Infinity, dy ? (HIGH / 2 + 4) / Math.abs(dy) : Infinity));
  return { x: x + dx * share, y: y + dy * share };
}

/** A link drawn from box to box, bent where a box or another link is in its way; and the middle of it. */
export function course(start: Point, end: Point, others: Point[], twin: number): { path: string; middle: Point } {
  const [dx, dy] = [end.x - start.x, end.y - start.y];
  const length = Math.hypot(dx, dy) || 1;
  const offsets = others.flatMap((other) => {
    const along = ((other.x - start.x) * dx + (other.y - start.y) * dy) / length ** 2;
    const off = ((other.x - start.x) * dy - (other.y - start.y) * dx) / length; // how far to the side of the turn
    return along > 0.05 && along < 0.95 && Math.abs(off) < HIGH ? [off] : [];
  });
  const away = offsets.reduce((sum, off) => sum + off, 0) > 0 ? -1 : 1;
  const bend = away * ((offsets.length ? 110 : 0) + 50 * twin);
  const turn = { x: (start.x + end.x) / 2 + (dy / length) * bend, y: (start.y + end.y) / 2 - (dx / length) * bend };
  const [from, to] = [leaves(start, turn), leaves(end, turn)];
  return {
    path: bend ? `M${from.x} ${from.y}Q${turn.x} ${turn.y} ${to.x} ${to.y}` : `M${from.x} ${from.y}L${to.x} ${to.y}`,
    middle: bend ? { x: (from.x + 2 * turn.x + to.x) / 4, y: (from.y + 2 * turn.y + to.y) / 4 } : { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 },
  };
}
