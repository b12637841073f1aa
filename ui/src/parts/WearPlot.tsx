import { type ReactNode, useEffect, useMemo, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { type Curve, Plot } from "./Plot";

type Wear = Shapes["WearOverTime"];

/** The wear of a failure mode: its readings, the course that they foretell with its band, its threshold, and when that is reached. */
export function WearPlot({ one }: { one: Shapes["WornPart"] }): ReactNode {
  const [found, setFound] = useState<Wear | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    const asked = new AbortController();
    get("/api/wear", { mode: one.mode }, asked.signal)
      .then((wear) => {
        setFound(wear);
        setWrong("");
      })
      .catch((error: Error) => asked.signal.aborted || setWrong(error.message));
    return () => asked.abort();
  }, [one.mode, one.readings]);
  const { curves, band } = useMemo(() => drawn(found?.seen.mode === one.mode ? found : null), [found, one.mode]);
  return (
    <Plot title={`Wear of ${one.mode}`} yLabel={one.signal} xLabel={`age of the part [${one.unit}]`} curves={curves} band={band} height={260} empty={wrong || "…"}>
      <p className="small quiet">{found?.band ? "Dashed: the course that its own readings foretell, by its median and 90 % of what may come." : "Its readings alone foretell no course to the threshold."}</p>
    </Plot>
  );
}

function drawn(wear: Wear | null): { curves: Curve[]; band?: [number, number] } {
  if (!wear?.times.length) return { curves: [] };
  const { early, late, threshold } = wear.seen;
  const [first, last] = [wear.times[0]!, wear.times.at(-1)!];
  const ahead = wear.band;
  const course = (name: string, y: number[], more: Partial<Curve>): Curve => ({ name, x: ahead!.times, y, dashed: true, ...more });
  const curves: Curve[] = [
    ...(ahead ? [course("course, 5 %", ahead.fast, { color: 5 }), course("95 %", ahead.slow, { color: 5 }), course("median", ahead.median, { color: 0 })] : []),
    { name: "readings", x: wear.times, y: wear.values, dots: true, color: 0 },
    { name: "threshold", x: [first, last + (late ?? early ?? 0)], y: [threshold, threshold], color: 1 },
    ...(early != null && late != null && late > 0 ? [{ name: "reached, with 90 %", x: [last + early, last + late], y: [threshold, threshold], color: 3, thick: true }] : []),
  ];
  return { curves, band: ahead ? [0, 1] : undefined };
}
