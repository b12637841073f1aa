import { type ReactNode, useEffect } from "react";
import { askWho, visitor } from "../lib/access";
import { useShared } from "../lib/store";

/** Who is logged in, in which role, and the way out; nothing where anybody may. */
export function User(): ReactNode {
  const user = useShared(visitor);
  useEffect(askWho, []);
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
