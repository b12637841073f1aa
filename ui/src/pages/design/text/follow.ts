// What others make of the design while it is written as text: taken in where it touches nothing that is written here.
import { type ChangeSet, ChangeSet as Changes, Transaction } from "@codemirror/state";
import { EditorView } from "@codemirror/view";

/** The one stretch in which two texts differ, as a change of the first. */
function difference(before: string, after: string): { from: number; to: number; insert: string } {
  let from = 0;
  while (from < before.length && from < after.length && before[from] === after[from]) from++;
  let end = 0;
  while (end < before.length - from && end < after.length - from && before.at(-1 - end) === after.at(-1 - end)) end++;
  return { from, to: before.length - end, insert: after.slice(from, after.length - end) };
}

/** The text that was last read of the design, and what has been changed in it here since. */
export class Followed {
  private mine: ChangeSet;

  constructor(
    public base: string,
    /** The design's revision that has this text. */
    public revision: number,
  ) {
    this.mine = Changes.empty(base.length);
  }

  /** Follow what is written in the editor. */
  readonly listener = EditorView.updateListener.of((update) => {
    if (update.docChanged && !update.transactions.some((one) => one.annotation(Transaction.remote))) this.mine = this.mine.compose(update.changes);
  });

  /** What was sent to become the design, and is to be known when it comes back as such. */
  sent: string | null = null;

  /** Begin anew from the text that the design now has; what is shown may differ from it. */
  begin(text: string, revision: number, shown: string): void {
    Object.assign(this, { base: text, revision, sent: null });
    this.mine = Changes.of(difference(text, shown), text.length);
  }

  /** Take in the text that the design now has; false where it was changed where something was written here too. */
  take(view: EditorView, text: string, revision: number): boolean {
    if (text === this.sent) {
      this.begin(text, revision, view.state.doc.toString());
      return true;
    }
    const change = difference(this.base, text);
    const theirs = Changes.of(change, this.base.length);
    if (!theirs.empty && !this.mine.empty && this.mine.touchesRange(change.from, change.to)) return false;
    const moved = theirs.map(this.mine);
    this.mine = this.mine.map(theirs, true);
    Object.assign(this, { base: text, revision });
    if (!moved.empty) view.dispatch({ changes: moved, annotations: [Transaction.remote.of(true), Transaction.addToHistory.of(false)] });
    return true;
  }
}
