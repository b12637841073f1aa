// Where in a YAML text a cursor stands: the keys that lead there, by indentation, and within {…} and […].
import { syntaxTree } from "@codemirror/language";
import type { EditorState } from "@codemirror/state";

/** An item of a list, among keys. */
export const ITEM = "-";

export interface Spot {
  /** Keys that lead to the mapping or value in which the cursor is. */
  path: string[];
  /** Whether a value is written here, or the name of a key. */
  value: boolean;
}

interface Token {
  column: number;
  step: string;
}

const KEY = /^("[^"]*"|'[^']*'|[^\s#{}[\],&*!|>%@`"'-][^#{}[\],]*?|-[^\s#{}[\],:][^#{}[\],]*?)\s*:(?=\s|$)/;

const bare = (key: string): string => key.trim().replace(/^(["'])(.*)\1$/, "$2");

/** Dashes and the key with which a line begins, and where what follows them begins. */
function tokensOf(line: string): { tokens: Token[]; rest: number } {
  const tokens: Token[] = [];
  let at = line.search(/\S|$/);
  for (let dash = /^-(\s+|$)/.exec(line.slice(at)); dash; dash = /^-(\s+|$)/.exec(line.slice(at))) {
    tokens.push({ column: at, step: ITEM });
    at += dash[0].length;
  }
  const key = KEY.exec(line.slice(at));
  if (key) {
    tokens.push({ column: at, step: bare(key[1]!) });
    at += key[0].length;
  }
  return { tokens, rest: at };
}

/** The keys above a column of a line, each further left than the one below it; a list may stand as far left as its key. */
function above(state: EditorState, line: number, tokens: Token[], column: number): string[] {
  const path = tokens.map((one) => one.step);
  let first: Token = tokens[0] ?? { column, step: "" };
  for (let number = line - 1; number > 0 && (first.column > 0 || first.step === ITEM); number--) {
    const text = state.doc.line(number).text;
    if (/^\s*(#|$)/.test(text)) continue;
    for (const token of tokensOf(text).tokens.reverse()) {
      const outer = token.column < first.column || (token.column === first.column && first.step === ITEM && token.step !== ITEM);
      if (!outer) continue;
      path.unshift(token.step);
      first = token;
    }
  }
  return path;
}

/** What a text in {…} and […] has opened and not closed: their steps, and whether a value is written at its end. */
function opened(text: string): { steps: string[]; value: boolean } {
  const frames: { list: boolean; key: string; from: number }[] = [];
  for (const found of text.matchAll(/"[^"]*"|'[^']*'|[{[\]},]|:(?=\s|$)/g)) {
    const top = frames.at(-1);
    const end = found.index + found[0].length;
    if (found[0] === "{" || found[0] === "[") frames.push({ list: found[0] === "[", key: "", from: end });
    else if (found[0] === "}" || found[0] === "]") frames.pop();
    else if (found[0] === "," && top) Object.assign(top, { key: "", from: end });
    else if (found[0] === ":" && top) Object.assign(top, { key: bare(text.slice(top.from, found.index)), from: end });
  }
  const top = frames.at(-1);
  return { steps: frames.flatMap((one) => (one.list ? ITEM : one.key || [])), value: !top || top.list || top.key !== "" };
}

/** Where the outermost {…} or […] around a position begins. */
function flowStart(state: EditorState, at: number): number | null {
  let start: number | null = null;
  for (let node = syntaxTree(state).resolveInner(at, -1).node; node.parent; node = node.parent)
    if (/^Flow(Mapping|Sequence)$/.test(node.name) && node.from < at) start = node.from;
  return start;
}

export function spotAt(state: EditorState, at: number): Spot {
  const from = flowStart(state, at) ?? at;
  const line = state.doc.lineAt(from);
  const { tokens, rest } = tokensOf(line.text.slice(0, from - line.from));
  const column = from < at || tokens.length ? rest : from - line.from - wordBefore(line.text.slice(0, from - line.from));
  const path = above(state, line.number, tokens, column);
  if (from < at) {
    const flow = opened(state.sliceDoc(from, at));
    return { path: [...path, ...flow.steps], value: flow.value };
  }
  return { path, value: tokens.length > 0 && tokens.at(-1)!.step !== ITEM };
}

const wordBefore = (text: string): number => /[^\s]*$/.exec(text)![0].length;

/** The keys that lead to, and include, the key that is written around a position; null where none is. */
export function keyAt(state: EditorState, at: number): { path: string[]; from: number; to: number } | null {
  const line = state.doc.lineAt(at);
  const inner = line.text.slice(at - line.from);
  const before = /(?:"[^"]*|'[^']*|[^\s,{}[\]:#"'][^,{}[\]:#"']*)$/.exec(line.text.slice(0, at - line.from))?.[0].trimStart() ?? "";
  const after = /^[^,{}[\]:#]*:(?=\s|$)/.exec(inner)?.[0];
  if (after === undefined) return null;
  const from = at - before.length;
  const to = at + after.length - 1;
  const name = bare(state.sliceDoc(from, to)).replace(/^- +/, "");
  if (!name) return null;
  return { path: [...spotAt(state, from).path, name], from, to };
}

/** The place of a value in the text as far as its keys are found, each deeper than the one before it. */
export function positionOf(state: EditorState, place: string[]): number {
  let found = 0;
  let number = 1;
  let deeper = -1;
  for (const key of place) {
    for (; number <= state.doc.lines; number++) {
      const line = state.doc.line(number);
      const token = tokensOf(line.text).tokens.at(-1);
      if (!token || token.step === ITEM) continue;
      if (token.column <= deeper) return found;
      if (token.step !== key) continue;
      found = line.from + token.column;
      deeper = token.column;
      number++;
      break;
    }
  }
  return found;
}
