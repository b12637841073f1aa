// Every plot over time or hours is drawn here, by uPlot.
import { type ReactNode, type RefObject, useEffect, useMemo, useRef, useState } from "react";
import uPlot, { type AlignedData } from "uplot";
import "uplot/dist/uPlot.min.css";
import { csvOf, offer, pngOf, svgOf } from "../lib/exports";
import { preferences, useShared } from "../lib/store";
import { TIME_STEPS, tickTimes, timeText } from "../lib/ticks";
import { momentText, numberText, zoneText } from "../lib/words";

export interface Curve {
  name: string;
  x: number[];
  y: (number | null)[];
  /** By habit nominal is solid, sensor-based dashed. */
  dashed?: boolean;
  color?: number;
  /** Each point is a dot, and no line leads from one to the next. */
  dots?: boolean;
  thick?: boolean;
}

export interface PlotProps {
  title: string;
  curves: Curve[];
  xLabel: string;
  yLabel: string;
  /** x are seconds since the epoch. */
  time?: boolean;
  log?: boolean;
  height?: number;
  /** Spans of x in which a sensor was silent. */
  gaps?: [number, number][];
  /** Places on x where something happened; a dashed line each. */
  marks?: number[];
  /** The place on x that is looked at; a solid line. */
  at?: number | null;
  /** A span of x was dragged across: whoever listens draws what is in it. */
  zoomTo?: (from: number, to: number) => void;
  /** A place on x was clicked. */
  pick?: (x: number) => void;
  /** Limits of what is drawn: a line each, where it is in sight; said in words wherever it is. */
  limits?: Limit[];
  /** Two curves with the same x, by their places, between which the plot is filled. */
  band?: [number, number];
  empty?: string;
  children?: ReactNode;
}

export interface Limit {
  value: number;
  severity: "error" | "warn";
}

const DASH = [6, 4];
const MANY = 6; // curves that are drawn thick

function css(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function joined(curves: Curve[], log: boolean): AlignedData {
  const sound = (y: (number | null)[]): (number | null)[] => (log ? y.map((one) => (one != null && one > 0 ? one : null)) : y);
  const first = curves[0];
  if (!first) return [[]];
  if (curves.every((one) => one.x === first.x || (one.x.length === first.x.length && one.x[0] === first.x[0] && one.x.at(-1) === first.x.at(-1))))
    return [first.x, ...curves.map((one) => sound(one.y))] as AlignedData;
  return uPlot.join(curves.map((one) => [one.x, sound(one.y)] as AlignedData));
}

export function Plot({ title, curves, xLabel: over, yLabel, time, log = false, height = 230, gaps, limits, band, marks, at, zoomTo, pick, empty, children }: PlotProps): ReactNode {
  const xLabel = time ? `${over}, ${zoneText(Math.max(0, ...curves.map((one) => one.x.at(-1) ?? 0)))}` : over;
  const box = useRef<HTMLDivElement>(null);
  const under = useRef<HTMLSpanElement>(null);
  const plot = useRef<uPlot | null>(null);
  const shaded = useRef(gaps);
  shaded.current = gaps;
  const marked = useRef({ marks, at });
  marked.current = { marks, at };
  const told = useRef({ zoomTo, pick });
  told.current = { zoomTo, pick };
  const dragged = useRef(false);
  const lines = useRef(limits);
  lines.current = limits;
  const { theme } = useShared(preferences);
  const [zoomed, setZoomed] = useState(false);
  const held = useRef(false);
  const drawn = useRef<Curve[]>([]);
  const words = useRef({ text: "", at: 0, of: "" });
  const some = curves.some((one) => one.x.length);
  const seen = useSeen(box, some);
  const shape = curves.map((one) => `${one.name}|${one.dashed}|${one.color}|${one.dots}`).join("\n");

  useEffect(() => {
    const host = box.current;
    if (!host || !some) return;
    const line = css("--line");
    const axis = { stroke: css("--quiet"), grid: { stroke: css("--edge"), width: 1 }, ticks: { stroke: line }, font: "12px system-ui, sans-serif" };
    const made = new uPlot(
      {
        width: Math.max(host.clientWidth, 120),
        height,
        legend: { show: false },
        cursor: { drag: { x: true, y: false }, points: { size: 6 }, sync: time ? { key: "time" } : undefined },
        scales: { x: { time: false, range: (_, low, high) => (low < high ? [low, high] : [low - 30, high + 30]) }, y: log ? { distr: 3 } : { range: (_, low, high) => spread(low, high) } },
        axes: [
          time
            ? { ...axis, incrs: TIME_STEPS, splits: (_u, _axis, low, high, step) => tickTimes(low, high, step), values: (_, ticks, _axis, _space, step) => ticks.map((tick) => timeText(tick, step)), space: 72 }
            : { ...axis, values: (_, ticks) => ticks.map((tick) => numberText(tick, 6)), space: 60 },
          { ...axis, size: 74, values: (_, ticks) => ticks.map((tick) => (tick == null ? "" : numberText(tick, log ? 2 : 7))) },
        ],
        series: [
          {},
          ...curves.map((one, i) => ({
            label: one.name,
            stroke: css(`--c${(one.color ?? i) % 6}`),
            width: one.thick ? 6 : curves.length > MANY ? 1 : 2,
            dash: one.dashed ? DASH : undefined,
            ...(one.dots ? { paths: () => null, points: { show: true, size: 5, fill: css(`--c${(one.color ?? i) % 6}`) } } : { points: { show: false, filter: (u: uPlot, i: number) => alone(u.data[i]!) } }),
          })),
        ],
        bands: band && [{ series: [band[0] + 1, band[1] + 1], fill: css("--hatch") }],
        hooks: {
          ready: [
            (u) => {
              u.over.addEventListener("mousedown", () => (dragged.current = true));
              u.over.addEventListener("click", () => {
                const x = u.posToVal(u.cursor.left ?? -1, "x");
                if (u.select.width < 2 && Number.isFinite(x)) told.current.pick?.(x);
              });
            },
          ],
          drawClear: [(u) => shade(u, shaded.current ?? []), (u) => mark(u, marked.current.marks ?? [], marked.current.at)],
          draw: [(u) => rule(u, lines.current ?? [])],
          setCursor: [(u) => void (under.current && (under.current.textContent = underCursor(u, time)))],
          setSelect: [
            (u) => {
              if (told.current.zoomTo) {
                if (dragged.current && u.select.width > 0) told.current.zoomTo(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
                dragged.current = false; // a plot beside it that follows the cursor has the same selection
                u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
                return;
              }
              held.current = true;
              setZoomed(true);
            },
          ],
        },
      },
      joined(curves, log),
      host,
    );
    plot.current = made;
    drawn.current = curves;
    const observer = new ResizeObserver(() => made.setSize({ width: Math.max(host.clientWidth, 120), height }));
    observer.observe(host);
    return () => {
      observer.disconnect();
      made.destroy();
      plot.current = null;
    };
    // curves' points are put in by the effect below; only their look makes the plot anew
  }, [shape, log, height, theme, some, time]);

  useEffect(() => {
    const now = plot.current;
    const before = drawn.current;
    const same = before.length === curves.length && curves.every((one, i) => one.x === before[i]!.x && one.y === before[i]!.y);
    if (!now || !seen || same) return;
    inTurn(box, () => {
      if (now !== plot.current) return;
      drawn.current = curves;
      const { min, max } = now.scales.x ?? {};
      now.setData(joined(curves, log), !held.current);
      if (held.current && min != null && max != null) now.setScale("x", { min, max });
    });
  }, [curves, log, seen]);

  useEffect(() => plot.current?.redraw(false), [marks, at]);
  const bounds = limits?.map((one) => `${one.severity} ${one.value}`).join();
  useEffect(() => plot.current?.redraw(false), [bounds, shape, some]);

  const reset = (): void => {
    held.current = false;
    setZoomed(false);
    plot.current?.setData(joined(curves, log), true);
  };

  const visible = (): Curve[] => {
    const { min, max } = plot.current?.scales.x ?? {};
    if (min == null || max == null) return curves;
    return curves.map((one) => {
      const rows = one.x.map((x, i) => [x, one.y[i] ?? null] as const).filter(([x]) => x >= min && x <= max);
      return { ...one, x: rows.map(([x]) => x), y: rows.map(([, y]) => y) };
    });
  };

  const picture = async (): Promise<void> => {
    if (!plot.current) return;
    const blob = await pngOf(plot.current.ctx.canvas, curves, { title, xLabel, yLabel }, { ground: css("--card"), ink: css("--ink"), of: (i) => css(`--c${i % 6}`) });
    if (blob) offer(`${title}.png`, "image/png", blob);
  };

  const key = `${shape} ${some} ${yLabel}`;
  if (key !== words.current.of || performance.now() - words.current.at > 1000) {
    const last = curves.map((one) => `${one.name} ${numberText(one.y.at(-1), 5)}`).join(", ");
    words.current = { text: some ? `${title}, ${yLabel} over ${xLabel}. Latest: ${last}.` : `${title}: ${empty ?? "no data yet"}`, at: performance.now(), of: key };
  }
  // names, dashes and colours are in the shape; points are nothing to a legend
  const legend = useMemo(() => <Legend curves={curves} />, [shape]);
  return (
    <section className="plot card" aria-label={title}>
      <h2>
        {title} <span className="quiet small">{yLabel}</span>
      </h2>
      {legend}
      {!!limits?.length && (
        <p className="small quiet limits">
          {limits.map((one) => `${one.severity === "error" ? "limit" : "warning"} ${numberText(one.value, 5)}`).join(", ")}
        </p>
      )}
      {some ? <div ref={box} role="img" aria-label={words.current.text} /> : <p className="quiet">{empty ?? "No data yet."}</p>}
      {children}
      <div className="tools">
        <span className="small quiet grow">
          {xLabel} <span ref={under} className="under" />
        </span>
        {zoomed && <button onClick={reset}>Whole range</button>}
        <button disabled={!some} onClick={() => offer(`${title}.csv`, "text/csv", csvOf(visible(), time ? `${over}, UTC` : over, time))} aria-label={`${title} as CSV, the visible range`}>
          CSV
        </button>
        <button disabled={!some} onClick={() => offer(`${title}.svg`, "image/svg+xml", svgOf(visible(), { title, xLabel, yLabel, log, time, limits }))} aria-label={`${title} as SVG`}>
          SVG
        </button>
        <button
          disabled={!some}
          aria-label={`${title} as PNG`}
          onClick={() => void picture()}
        >
          PNG
        </button>
      </div>
    </section>
  );
}

/** Places of the points that no line reaches, between two breaks or as the only one: each is a dot. */
function alone(values: ArrayLike<number | null | undefined>): number[] {
  const found: number[] = [];
  let [last, long] = [0, 0]; // of the points in line so far
  for (let i = 0; i <= values.length; i++) {
    const value = values[i];
    if (value === undefined && i < values.length) continue; // another curve has a point here
    if (value == null) {
      if (long === 1) found.push(last);
      long = 0;
    } else [last, long] = [i, long + 1];
  }
  return found;
}

/** What the curves are where the cursor is; the point before it, where a curve has none just there. */
function underCursor(u: uPlot, time: boolean | undefined): string {
  const at = u.cursor.idx;
  const x = at == null ? null : u.data[0][at];
  if (at == null || x == null) return "";
  const values = u.series.slice(1).map((one, i) => {
    const column = u.data[i + 1]!;
    let row = at;
    while (row > 0 && column[row] === undefined) row--;
    return `${String(one.label)} ${numberText(column[row], 5)}`;
  });
  return `${time ? momentText(x) : numberText(x, 5)}: ${values.join(", ")}`;
}

function Legend({ curves }: { curves: Curve[] }): ReactNode {
  return (
    <div className="legend" aria-hidden="true">
      {curves.map((one, i) => (
        <span key={one.name}>
          <svg viewBox="0 0 26 8">
            <path d="M0 4h26" stroke={`var(--c${(one.color ?? i) % 6})`} strokeWidth={one.dots ? 5 : 2.5} strokeDasharray={one.dots ? "0.1 10" : one.dashed ? "6 4" : undefined} strokeLinecap={one.dots ? "round" : undefined} />
          </svg>
          {one.name}
        </span>
      ))}
    </div>
  );
}

/** Whether something can be seen: what cannot is not drawn. */
function useSeen(box: RefObject<HTMLElement | null>, there: boolean): boolean {
  const [seen, setSeen] = useState(true);
  useEffect(() => {
    const host = box.current;
    if (!host) return;
    const observer = new IntersectionObserver(([entry]) => setSeen(entry?.isIntersecting ?? true), { rootMargin: "100px" });
    observer.observe(host);
    return () => observer.disconnect();
  }, [box, there]);
  return seen;
}

const waiting = new Map<object, () => void>();

/** One plot a frame, so that no frame takes long; what has come meanwhile is drawn in the place of what waits. */
function inTurn(plot: object, draw: () => void): void {
  if (!waiting.size) requestAnimationFrame(next);
  waiting.set(plot, draw);
}

function next(): void {
  const [first] = waiting;
  if (!first) return;
  waiting.delete(first[0]);
  if (waiting.size) requestAnimationFrame(next);
  first[1]();
}

/** A range around the data, never of no width: 0.9999 must not look like an empty plot. */
function spread(low: number, high: number): [number, number] {
  if (low == null || high == null || !Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  if (high - low <= 1e-12 * Math.max(Math.abs(low), Math.abs(high))) {
    const room = 0.05 * Math.abs(low) || 1;
    return [low - room, high + room];
  }
  const pad = 0.07 * (high - low);
  return [low >= 0 && low < 0.25 * high ? 0 : low - pad, high + pad];
}

/** A line across at each limit that is in sight. */
function rule(u: uPlot, limits: Limit[]): void {
  u.ctx.save();
  u.ctx.lineWidth = 1.5 * devicePixelRatio;
  u.ctx.setLineDash([4 * devicePixelRatio, 2 * devicePixelRatio]);
  for (const { value, severity } of limits) {
    const y = u.valToPos(value, "y", true);
    if (!(y >= u.bbox.top && y <= u.bbox.top + u.bbox.height)) continue;
    u.ctx.strokeStyle = css(`--${severity}`);
    u.ctx.beginPath();
    u.ctx.moveTo(u.bbox.left, y);
    u.ctx.lineTo(u.bbox.left + u.bbox.width, y);
    u.ctx.stroke();
  }
  u.ctx.restore();
}

function shade(u: uPlot, gaps: [number, number][]): void {
  if (!gaps.length) return;
  u.ctx.save();
  u.ctx.fillStyle = css("--hatch");
  for (const [from, to] of gaps) {
    const left = Math.max(u.valToPos(from, "x", true), u.bbox.left);
    const right = Math.min(u.valToPos(to, "x", true), u.bbox.left + u.bbox.width);
    if (right > left) u.ctx.fillRect(left, u.bbox.top, right - left, u.bbox.height);
  }
  u.ctx.restore();
}

/** Lines upright where something happened, and where it is looked. */
function mark(u: uPlot, marks: number[], at: number | null | undefined): void {
  const line = (x: number, color: string, dash: number[]): void => {
    const left = u.valToPos(x, "x", true);
    if (!(left >= u.bbox.left && left <= u.bbox.left + u.bbox.width)) return;
    u.ctx.strokeStyle = css(color);
    u.ctx.setLineDash(dash);
    u.ctx.beginPath();
    u.ctx.moveTo(left, u.bbox.top);
    u.ctx.lineTo(left, u.bbox.top + u.bbox.height);
    u.ctx.stroke();
  };
  u.ctx.save();
  u.ctx.lineWidth = devicePixelRatio;
  for (const one of marks) line(one, "--warn", DASH);
  if (at != null) line(at, "--ink", []);
  u.ctx.restore();
}
