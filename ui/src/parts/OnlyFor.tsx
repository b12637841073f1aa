import type { ReactNode } from "react";
import { type Role, useRefusal } from "../lib/access";

/** Controls for those who have a role, or more; greyed for all others, with the reason. */
export function OnlyFor({ role, children }: { role: Role; children: ReactNode }): ReactNode {
  const refusal = useRefusal(role);
  return (
    <fieldset className="only" disabled={refusal !== ""} title={refusal || undefined} aria-label={refusal || undefined}>
      {children}
    </fieldset>
  );
}
