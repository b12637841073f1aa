// What the JSON Schema of the design file says of a place in it.
import { ITEM } from "./place";

export interface Node {
  $ref?: string;
  $defs?: Record<string, Node>;
  anyOf?: Node[];
  oneOf?: Node[];
  title?: string;
  description?: string;
  type?: string | string[];
  default?: unknown;
  enum?: unknown[];
  const?: unknown;
  examples?: unknown[];
  properties?: Record<string, Node>;
  patternProperties?: Record<string, Node>;
  additionalProperties?: Node | boolean;
  propertyNames?: Node;
  items?: Node;
}

export class Schema {
  constructor(private readonly root: Node) {}

  /** All that a value at a place may be. */
  at(path: string[]): Node[] {
    return path.reduce((nodes, key) => nodes.flatMap((node) => this.into(node, key)), this.choices(this.root));
  }

  /** A node and all that it refers to, or may be instead. */
  private choices(node: Node): Node[] {
    const defined = node.$ref && this.root.$defs?.[node.$ref.replace("#/$defs/", "")];
    const others = [...(defined ? [defined] : []), ...(node.anyOf ?? []), ...(node.oneOf ?? [])];
    return [node, ...others.flatMap((one) => this.choices(one))];
  }

  private into(node: Node, key: string): Node[] {
    const patterns = Object.entries(node.patternProperties ?? {}).filter(([pattern]) => new RegExp(pattern, "u").test(key));
    const more = typeof node.additionalProperties === "object" ? node.additionalProperties : undefined;
    const next = key === ITEM ? node.items : (node.properties?.[key] ?? patterns[0]?.[1] ?? more);
    return next ? this.choices(next) : [];
  }

  /** The keys that a mapping at a place may have, with what is said of each. */
  keys(path: string[]): { key: string; about: string }[] {
    const found = new Map<string, string>();
    for (const node of this.at(path)) {
      for (const key of Object.keys(node.properties ?? {})) found.set(key, this.about([...path, key]));
      for (const key of node.propertyNames?.enum ?? []) found.set(String(key), "");
    }
    return [...found].map(([key, about]) => ({ key, about }));
  }

  /** The values that a place may have, where these are counted, and examples where they are not. */
  values(path: string[]): string[] {
    const nodes = this.at(path);
    const all = nodes.flatMap((node) => [
      ...(node.enum ?? []),
      ...(node.const === undefined ? [] : [node.const]),
      ...(node.type === "boolean" ? [true, false] : []),
      ...(node.examples ?? []),
    ]);
    return [...new Set(all.map(String))];
  }

  /** What is said of a place: its description, what it may be, what it is where it is not stated. */
  about(path: string[]): string {
    const nodes = this.at(path);
    const said = [...new Set(nodes.map((node) => node.description).filter((one) => one))];
    const counted = nodes.flatMap((node) => [...(node.enum ?? []), ...(node.const === undefined ? [] : [node.const])]);
    const usual = nodes.find((node) => node.default != null)?.default;
    return [
      ...said,
      ...(counted.length ? [`One of: ${counted.join(", ")}.`] : []),
      ...(usual === undefined ? [] : [`Default: ${JSON.stringify(usual)}.`]),
    ].join("\n");
  }
}
