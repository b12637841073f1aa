import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../lib/api";

/** Who is logged in, in which role, and the way out; nothing where anybody may. */
export function User(): ReactNode {
  const [user, setUser] = useState<Shapes["Visitor"]>();
  useEffect(() => void get("/api/access").then(setUser, () => undefined), []);
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
