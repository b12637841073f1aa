// What the editor knows of the design file: keys and values to choose from, what they mean, what is wrong in the text.
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { type Diagnostic, linter, setDiagnosticsEffect } from "@codemirror/lint";
import type { EditorState, Extension } from "@codemirror/state";
import { type EditorView, hoverTooltip, ViewPlugin, type ViewUpdate } from "@codemirror/view";
import { type Problem, post, Refused } from "../../../lib/api";
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

/** How long to wait until a service that did not answer is asked again. [ms] */
const AGAIN = 2000;

/** The service's check of the text as it is written; one that is not answered leaves what is marked, and is made again. */
async function check(view: EditorView): Promise<Diagnostic[]> {
  const { doc } = view.state;
  while (view.state.doc === doc && view.dom.isConnected) {
    try {
      const { problems } = await post("/api/design/check", { text: doc.toString() });
      return problems.map((one) => diagnostic(view.state, one));
    } catch (error) {
      if (error instanceof Refused && error.status !== 0 && error.status < 500) return []; // of this text there will be no other answer
      await new Promise((go) => setTimeout(go, AGAIN));
    }
  }
  return [];
}

/** A message under a pointer that rests goes when its text is checked anew: the pointer is told again of where it is, which shows the new one. */
const pointed = ViewPlugin.fromClass(
  class {
    private at: { clientX: number; clientY: number } | null = null;
    constructor(private readonly view: EditorView) {}
    update(update: ViewUpdate): void {
      if (this.at && update.transactions.some((one) => one.effects.some((effect) => effect.is(setDiagnosticsEffect)))) requestAnimationFrame(() => this.again());
    }
    rests(event: MouseEvent | null): void {
      this.at = event && { clientX: event.clientX, clientY: event.clientY };
    }
    private again(): void {
      const under = this.at && (this.view.root as Document).elementFromPoint(this.at.clientX, this.at.clientY);
      if (this.at && under && this.view.contentDOM.contains(under)) under.dispatchEvent(new MouseEvent("mousemove", { ...this.at, bubbles: true }));
    }
  },
  {
    eventObservers: {
      mousemove(event) {
        this.rests(event);
      },
      mouseleave() {
        this.rests(null);
      },
    },
  },
);

export const checked: Extension = [linter(check, { delay: 400 }), pointed];
