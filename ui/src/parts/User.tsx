import type { ReactNode } from "react";
import { useVisitor } from "../lib/visitor";

/** Who is logged in, in which role, and the way out; nothing where anybody may. */
export function User(): ReactNode {
  const user = useVisitor();
  if (!user?.name) return null;
  const leave = async (): Promise<void> => {
    await fetch("./logout", { method: "POST" });
    location.reload();
  };
  return (
    <>
      <span className="quiet small">
        {user.name} ({user.role})
      </span>
      {user.session && <button onClick={() => void leave()}>Log out</button>}
    </>
  );
}
