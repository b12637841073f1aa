import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../../lib/api";
import { unitText } from "../../lib/words";
import { Select } from "../../parts/Field";
import { type Curve, Plot, type PlotProps } from "../../parts/Plot";
import { broken } from "./broken";

interface Asked extends Pick<PlotProps, "marks" | "at" | "zoomTo" | "pick"> {
  /** Units by the names of the signals whose courses are kept. */
  signals: Record<string, string | null>;
  span: [number, number] | null;
  /** Changes when it is to be asked again. */
  asked: string;
}

/** The kept course of one signal of stress, over the same time as the figures. */
export function SignalPlot({ signals, span, asked, ...plot }: Asked): ReactNode {
  const names = Object.keys(signals);
  const [chosen, setChosen] = useState("");
  const [found, setFound] = useState<Shapes["PastSignal"] | null>(null);
  const signal = names.includes(chosen) ? chosen : names[0];
  useEffect(() => {
    if (!signal) return;
    const ends = new AbortController();
    get("/api/history/signal", { signal, start: span?.[0], end: span?.[1], points: 800 }, ends.signal)
      .then(setFound)
      .catch(() => ends.signal.aborted || setFound(null)); // the figures beside it say why
    return () => ends.abort();
  }, [signal, span, asked]);
  if (!signal) return null;
  return (
    <Plot {...plot} title="Signal" xLabel="time" yLabel={`${signal} [${unitText(signals[signal]) || "as heard"}]`} time curves={found ? curves(found) : []} empty="Not known of this time.">
      {names.length > 1 && <Select label="signal" value={signal} options={names.map((one) => [one, one])} set={setChosen} />}
    </Plot>
  );
}

function curves(found: Shapes["PastSignal"]): Curve[] {
  const middle = found.times.map((time) => time + found.width / 2);
  const x = broken(found.breaks, middle, (i) => (middle[i - 1]! + middle[i]!) / 2);
  const curve = (name: string, values: (number | null)[], color: number): Curve => ({ name, x, y: broken(found.breaks, values, () => null), color });
  const { low, mean, high } = found.values;
  const ends = found.width ? [curve("lowest", low, 2), curve("highest", high, 3)] : [];
  return [...ends, curve(found.width ? "mean" : "mean of ten minutes", mean, 0)];
}
