import type { ReactNode } from "react";
import { outside, save, take, useDesign, useShared } from "../lib/store";
import { Changed } from "./Changed";
import { Dialog } from "./Dialog";

/** The file was changed by hand since it was read: what changed, and the ways out. Neither loses anything. */
export function OutsideDialog(): ReactNode {
  const found = useShared(outside);
  const design = useDesign();
  if (!found) return null;
  const close = (): void => outside.set(null);
  const then = (act: () => Promise<void>) => (): void => {
    close();
    void act();
  };
  return (
    <Dialog title="The file was changed by hand" close={close}>
      <p>{found.message}. What was changed in it meanwhile:</p>
      <Changed label="What was changed by hand" lines={found.changes} />
      <div className="row">
        <button className="primary" onClick={then(take)} title="What is here comes back by Undo">
          Reload the file
        </button>
        <button onClick={then(() => save(found.digest))} title={`What the file holds is kept as ${design?.file}.bak`}>
          Overwrite the file
        </button>
        <button onClick={close}>Cancel</button>
      </div>
      <p className="small quiet">
        Nothing is lost either way: what is here comes back by Undo, what the file holds is kept beside it as {design?.file}.bak.
      </p>
    </Dialog>
  );
}
