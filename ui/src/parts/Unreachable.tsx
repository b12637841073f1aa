import type { ReactNode } from "react";
import { connected } from "../lib/live";
import { unreachable, useShared } from "../lib/store";

/** That the service does not answer, as long as it does not. */
export function Unreachable(): ReactNode {
  const link = useShared(connected);
  const wrong = useShared(unreachable);
  if (!wrong && link !== "lost") return null;
  return (
    <div className="trouble" role="alert">
      <strong>The service does not answer.</strong> What you see may be old; the page tries again by itself. Is
      <code> robophm serve</code> still running?
    </div>
  );
}
