import { useEffect, useState } from "react";
import { get, type Shapes } from "./api";

/** Who is logged in, in which role; without a name where anybody may. Undefined until that is known. */
export function useVisitor(): Shapes["Visitor"] | undefined {
  const [visitor, setVisitor] = useState<Shapes["Visitor"]>();
  useEffect(() => void get("/api/access").then(setVisitor, () => undefined), []);
  return visitor;
}
