// What the editor knows of the design file: keys and values to choose from, what they mean, what is wrong in the text.
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { type Diagnostic, linter } from "@codemirror/lint";
import type { EditorState, Extension } from "@codemirror/state";
import { type EditorView, hoverTooltip } from "@codemirror/view";
import { type Problem, post } from "../../../lib/api";
import { keyAt, spotAt } from "./place";
import type { Schema } from "./keys";

export const completion =
  (schema: Schema) =>
  (context: CompletionContext): CompletionResult | null => {
    const word = context.matchBefore(/[\w-]*/);
    const from = word?.from ?? context.pos;
    if (from === context.pos && !context.explicit) return null;
    const { path, value } = spotAt(context.state, from);
    const follows = /^\s*:/.test(context.state.sliceDoc(context.pos, context.state.doc.lineAt(context.pos).to));
    const options: Completion[] = value
      ? schema.values(path).map((label) => ({ label, type: "enum" }))
      : schema.keys(path).map(({ key, about }) => ({ label: key, apply: follows ? key : `${key}: `, info: about || undefined, type: "property" }));
    return options.length ? { from, options, validFor: /^[\w -]*$/ } : null;
  };

export const explained = (schema: Schema): Extension =>
  hoverTooltip((view, at) => {
    const key = keyAt(view.state, at);
    const about = key && schema.about(key.path);
    if (!about) return null;
    const create = () => {
      const dom = Object.assign(document.createElement("div"), { className: "about", textContent: about });
      return { dom };
    };
    return { pos: key.from, end: key.to, create };
  });

/** Where in the text a problem is; without a line, its first. */
function diagnostic(state: EditorState, problem: Problem): Diagnostic {
  const line = state.doc.line(Math.min(Math.max(problem.line ?? 1, 1), state.doc.lines));
  const from = line.from + Math.min(problem.column ? problem.column - 1 : line.text.search(/\S|$/), line.length);
  return { from, to: Math.max(line.to, from), severity: problem.level, message: problem.message, source: problem.place.join("/") || undefined };
}

/** The service's check of the text as it is written. */
export const checked: Extension = linter(
  async (view: EditorView): Promise<Diagnostic[]> => {
    try {
      const { problems } = await post("/api/design/check", { text: view.state.doc.toString() });
      return problems.map((one) => diagnostic(view.state, one));
    } catch {
      return []; // that the service does not answer is said by the page
    }
  },
  { delay: 400 },
);
