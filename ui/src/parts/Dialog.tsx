import { type ReactNode, useEffect, useId, useRef } from "react";

export function Dialog({ title, close, children, className }: { title: string; close: () => void; children: ReactNode; className?: string }): ReactNode {
  const ref = useRef<HTMLDialogElement>(null);
  const id = useId();
  useEffect(() => {
    const dialog = ref.current;
    if (!dialog || dialog.open) return;
    dialog.showModal();
    const first = dialog.querySelector<HTMLElement>("input, select, textarea, .primary");
    first?.focus();
    if (first instanceof HTMLInputElement) first.select();
  }, []);
  return (
    <dialog ref={ref} className={className} aria-labelledby={id} onClose={close} onClick={(event) => event.target === ref.current && close()}>
      <h2 id={id}>{title}</h2>
      <button className="icon plain close" aria-label="Close" onClick={close}>
        ×
      </button>
      {children}
    </dialog>
  );
}

/** A dialog that asks for something, and does it unless something is wrong. */
export function Asking({ title, close, verb, wrong, done, children }: { title: string; close: () => void; verb: string; wrong?: boolean; done: () => void; children: ReactNode }): ReactNode {
  return (
    <Dialog title={title} close={close}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (wrong) return;
          close();
          done();
        }}
      >
        {children}
        <div className="row">
          <button className="primary" type="submit" disabled={wrong}>
            {verb}
          </button>
          <button type="button" onClick={close}>
            Cancel
          </button>
        </div>
      </form>
    </Dialog>
  );
}
