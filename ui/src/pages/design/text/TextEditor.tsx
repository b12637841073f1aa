import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import { bracketMatching, foldGutter, foldKeymap, indentOnInput } from "@codemirror/language";
import { lintGutter, lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { EditorState, type Extension } from "@codemirror/state";
import { drawSelection, EditorView, keymap, lineNumbers } from "@codemirror/view";
import { type ReactNode, useEffect, useRef, useState } from "react";
import { get } from "../../../lib/api";
import { replaceText, save, sayError, useDesign } from "../../../lib/store";
import { Followed } from "./follow";
import { checked, completion, explained } from "./help";
import { look } from "./look";
import { positionOf } from "./place";
import { type Node, Schema } from "./keys";
import { keep, unapplied } from "./unapplied";
import { OnlyFor } from "../../../parts/OnlyFor";

/** Typing over a selection: the browser would keep the look of what was there by an inline style, which the service's policy refuses. */
const typedOver = EditorView.domEventHandlers({
  beforeinput(event, view) {
    const { from, to, empty } = view.state.selection.main;
    const text = event.data;
    if (event.inputType !== "insertText" || !text || empty || view.composing) return false;
    const insert = () => view.state.update(view.state.replaceSelection(text), { userEvent: "input.type", scrollIntoView: true });
    if (!view.state.facet(EditorView.inputHandler).some((handled) => handled(view, from, to, text, insert))) view.dispatch(insert());
    return true;
  },
});

const usual = (schema: Schema): Extension[] => [
  lintGutter(),
  lineNumbers(),
  foldGutter(),
  history(),
  drawSelection(),
  indentOnInput(),
  bracketMatching(),
  closeBrackets(),
  search({ top: true }),
  highlightSelectionMatches(),
  autocompletion({ override: [completion(schema)] }),
  explained(schema),
  checked,
  typedOver,
  yaml(),
  look,
  EditorView.contentAttributes.of({ "aria-label": "The design file (YAML)", spellcheck: "false", tabindex: "0" }),
  keymap.of([...closeBracketsKeymap, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...foldKeymap, ...completionKeymap, ...lintKeymap, indentWithTab]),
];

/** The design file as text; `place` is what to show first. */
export default function TextEditor({ place, close }: { place: string[]; close: () => void }): ReactNode {
  const design = useDesign();
  const host = useRef<HTMLDivElement>(null);
  const open = useRef<{ view: EditorView; followed: Followed } | null>(null);
  const [changed, setChanged] = useState(false);
  const [conflict, setConflict] = useState(false);
  const history = design?.history ?? 0;

  /** Say whether the text is the design's, and keep it where it is not. */
  const compare = useRef((view: EditorView, followed: Followed): void => {
    const { base, revision } = followed;
    const text = view.state.doc.toString();
    setChanged(text !== base);
    keep(history, text === base ? null : { text, base, revision });
  }).current;

  async function apply(): Promise<boolean> {
    if (!open.current) return false;
    const { view, followed } = open.current;
    const text = view.state.doc.toString();
    if (text === followed.base) return true;
    followed.sent = text;
    const done = await replaceText(text, "Edit the file as text", followed.revision, () => void apply());
    if (!done) followed.sent = null;
    return done;
  }
  const act = useRef({ save: () => true, place });
  act.current = {
    place,
    save: () => {
      void apply().then((done) => (done ? save() : undefined));
      return true;
    },
  };

  useEffect(() => {
    const root = host.current!.shadowRoot ?? host.current!.attachShadow({ mode: "open" });
    const ended = new AbortController();
    const begin = async (): Promise<void> => {
      const [schema, text] = await Promise.all([get("/api/design/schema", {}, ended.signal), get("/api/design/text", {}, ended.signal)]);
      const kept = unapplied(history);
      const followed = new Followed(text.text, text.revision);
      if (kept) followed.begin(kept.base, kept.revision, kept.text);
      const own = [
        followed.listener,
        EditorView.updateListener.of((update) => update.docChanged && compare(update.view, followed)),
        keymap.of([{ key: "Mod-s", preventDefault: true, run: () => act.current.save() }]),
      ];
      const state = EditorState.create({ doc: kept?.text ?? text.text, extensions: [...own, ...usual(new Schema(schema as Node))] });
      const view = new EditorView({ state, parent: root, root });
      const at = positionOf(view.state, act.current.place);
      view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: "start", yMargin: 20 }) });
      open.current = { view, followed };
      setConflict(!followed.take(view, text.text, text.revision));
      compare(view, followed);
      view.focus();
    };
    begin().catch((error) => ended.signal.aborted || sayError(error));
    return () => {
      ended.abort();
      open.current?.view.destroy();
      open.current = null;
    };
  }, []);

  const revision = design?.revision;
  useEffect(() => {
    const ended = new AbortController();
    const follow = async (): Promise<void> => {
      if (!open.current || open.current.followed.revision === revision) return;
      const now = await get("/api/design/text", {}, ended.signal);
      const { view, followed } = open.current;
      setConflict(!followed.take(view, now.text, now.revision));
      compare(view, followed);
    };
    follow().catch((error) => ended.signal.aborted || sayError(error));
    return () => ended.abort();
  }, [revision]);

  async function settle(theirs: boolean): Promise<void> {
    if (!open.current) return;
    const { view, followed } = open.current;
    const now = await get("/api/design/text");
    if (theirs) view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: now.text } });
    followed.begin(now.text, now.revision, view.state.doc.toString());
    setConflict(false);
    compare(view, followed);
  }

  return (
    <>
      <div className="row tools">
        <OnlyFor role="editor">
          <button className="primary" disabled={!changed || conflict} onClick={() => void apply()}>
            Apply
          </button>
        </OnlyFor>
        <button disabled={!changed} onClick={() => void settle(true)} title="Ctrl+Z in the text brings it back">
          Revert
        </button>
        <button onClick={close}>Close</button>
        <span className="quiet small" role="status">
          {changed ? "Not applied yet" : "As the design is"}
        </span>
      </div>
      {conflict && (
        <div className="trouble" role="alert">
          The design was changed meanwhile where you have changed it too.{" "}
          <button onClick={() => void settle(true)}>Take theirs</button> <button onClick={() => void settle(false)}>Keep mine</button>
        </div>
      )}
      <div
        className="file"
        ref={host}
        onKeyDown={(event) => {
          if (event.nativeEvent.defaultPrevented || !(event.ctrlKey || event.metaKey)) event.stopPropagation();
        }}
      />
      <p className="small quiet hint">Ctrl+Space: what may stand here. Ctrl+F: search. Ctrl+S: apply and save. F8: next problem. Escape, then Tab: out of the text.</p>
    </>
  );
}
