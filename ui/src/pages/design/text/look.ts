// The editor in the colours of the page, which change with its theme.
import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

const field = { font: "inherit", color: "var(--ink)", background: "var(--paper)", border: "1px solid var(--line)", borderRadius: "6px", minHeight: "30px" };

// the pictures that CodeMirror marks problems with are data, which the service's policy refuses
const wavy = (colour: string) => ({ backgroundImage: "none", textDecoration: `underline wavy ${colour}`, textUnderlineOffset: "3px" });
const dot = (colour: string, borderRadius: string) => ({ content: "normal", background: colour, borderRadius });

const theme = EditorView.theme({
  "&": { height: "100%", color: "var(--ink)", background: "var(--card)", fontSize: ".86rem" },
  "&.cm-focused": { outline: "2px solid var(--accent)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: 'ui-monospace, "DejaVu Sans Mono", monospace', lineHeight: "1.5" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor, .cm-dropCursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { background: "color-mix(in srgb, var(--accent) 24%, transparent)" },
  ".cm-gutters": { color: "var(--quiet)", background: "var(--card)", borderRight: "1px solid var(--edge)" },
  ".cm-searchMatch": { background: "color-mix(in srgb, var(--warn) 22%, transparent)" },
  ".cm-searchMatch-selected, .cm-selectionMatch": { background: "color-mix(in srgb, var(--warn) 34%, transparent)" },
  "&.cm-focused .cm-matchingBracket": { background: "none", outline: "1px solid var(--line)" },
  ".cm-panels": { color: "var(--ink)", background: "var(--shade)", borderColor: "var(--edge)", font: "inherit" },
  ".cm-textfield": field,
  ".cm-button": { ...field, backgroundImage: "none", background: "var(--card)", cursor: "pointer" },
  ".cm-panel.cm-search label": { fontSize: "inherit" },
  ".cm-panel.cm-search [name=close]": { color: "var(--ink)", fontSize: "1.2rem", minWidth: "24px" },
  ".cm-tooltip": { color: "var(--ink)", background: "var(--card)", border: "1px solid var(--line)", borderRadius: "6px", maxWidth: "min(420px, 92vw)" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]": { color: "var(--on-accent)", background: "var(--accent)" },
  ".cm-tooltip .about": { padding: "5px 9px", whiteSpace: "pre-line" },
  ".cm-completionInfo": { whiteSpace: "pre-line" },
  ".cm-lintRange-error": wavy("var(--error)"),
  ".cm-lintRange-warning": wavy("var(--warn)"),
  ".cm-lintRange-active": { background: "var(--shade)" },
  ".cm-lint-marker": { width: "10px", height: "10px", margin: "5px auto 0" },
  ".cm-lint-marker-error": dot("var(--error)", "50%"),
  ".cm-lint-marker-warning": dot("var(--warn)", "2px"),
  ".cm-diagnostic": { whiteSpace: "pre-wrap" },
  ".cm-diagnostic-error": { borderLeftColor: "var(--error)" },
  ".cm-diagnostic-warning": { borderLeftColor: "var(--warn)" },
});

const colours = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: "var(--accent)" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--ok)" },
  { tag: [tags.lineComment, tags.comment, tags.meta], color: "var(--quiet)", fontStyle: "italic" },
  { tag: [tags.keyword, tags.labelName, tags.typeName], color: "var(--error)" },
]);

export const look = [theme, syntaxHighlighting(colours)];
