// Who is logged in, and what they may do: the service decides, the page greys out what it would refuse.
import { get, type Shapes } from "./api";
import { Shared, useShared } from "./store";

export type Role = Shapes["Visitor"]["role"];

const ROLES: Role[] = ["viewer", "operator", "editor"];

export const visitor = new Shared<Shapes["Visitor"] | null>(null);

export const askWho = (): void => void get("/api/access").then((one) => visitor.set(one), () => undefined);

/** Why what is for a role is not for whoever is logged in; "" where it is, or that is not known yet. */
export function useRefusal(role: Role): string {
  const one = useShared(visitor);
  if (!one || ROLES.indexOf(one.role) >= ROLES.indexOf(role)) return "";
  return `For ${role}s; ${one.name || "who is not logged in"} is ${one.role === "viewer" ? "a" : "an"} ${one.role}`;
}
