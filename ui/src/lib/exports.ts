// What a person takes along: a plot as CSV or SVG, any text as a file.
import type { Curve, Limit } from "../parts/Plot";
import { timeTicks } from "./ticks";
import { numberText } from "./words";

export function offer(name: string, type: string, content: string | Blob): void {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name.replace(/[^\w.()+ -]/g, "_");
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Text that a spreadsheet would take for a formula is told to be text; numbers stay numbers. */
export function cell(said: string): string {
  const text = /^[=+\-@\t\r]/.test(said) && !Number.isFinite(Number(said)) ? `'${said}` : said;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** A row for each x that any curve has, a moment by its date; an empty cell where a curve has none. */
export function csvOf(curves: Curve[], xLabel: string, time = false): string {
  const rows = new Map<number, (number | null)[]>();
  curves.forEach((curve, i) =>
    curve.x.forEach((x, n) => {
      const row = rows.get(x) ?? curves.map(() => null);
      row[i] = curve.y[n] ?? null;
      rows.set(x, row);
    }),
  );
  const lines = [...rows].sort(([a], [b]) => a - b).map(([x, row]) => [time ? new Date(x * 1000).toISOString() : x, ...row.map((y) => y ?? "")].join(","));
  return [[xLabel, ...curves.map((one) => one.name)].map(cell).join(","), ...lines, ""].join("\n");
}

const COLORS = ["#0065a9", "#c65100", "#007d5c", "#a3397f", "#8a6a00", "#4a4f57"];

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (one) => `&#${one.charCodeAt(0)};`);
}

export interface Labels {
  title: string;
  xLabel: string;
  yLabel: string;
}

/** A plot as it is on screen, from its canvas, with its ground, title and legend. */
export function pngOf(canvas: HTMLCanvasElement, curves: Curve[], { title, xLabel, yLabel }: Labels, colors: { ground: string; ink: string; of: (i: number) => string }): Promise<Blob | null> {
  const ratio = devicePixelRatio;
  const [line, left] = [18 * ratio, 12 * ratio];
  const picture = document.createElement("canvas");
  picture.width = canvas.width;
  picture.height = canvas.height + (curves.length + 3) * line;
  const pen = picture.getContext("2d");
  if (!pen) return Promise.resolve(null);
  pen.fillStyle = colors.ground;
  pen.fillRect(0, 0, picture.width, picture.height);
  const write = (text: string, y: number, color: string, weight = 400): void => {
    pen.fillStyle = color;
    pen.font = `${weight} ${13 * ratio}px system-ui, sans-serif`;
    pen.fillText(text, left, y);
  };
  write(`${title}  ${yLabel}`, line, colors.ink, 600);
  curves.forEach((one, i) => write(`${one.dots ? "••" : one.dashed ? "╌╌" : "──"} ${one.name}`, (i + 2) * line, colors.of(one.color ?? i)));
  pen.drawImage(canvas, 0, (curves.length + 1.5) * line);
  write(xLabel, picture.height - line / 2, colors.ink);
  return new Promise((resolve) => picture.toBlob(resolve));
}

export function svgOf(curves: Curve[], { title, xLabel, yLabel, log, time = false, limits = [] }: Labels & { log: boolean; time?: boolean; limits?: Limit[] }): string {
  const [width, height, left, top, right, bottom] = [720, 400, 90, 50, 20, 60];
  const at = (y: number): number => (log ? Math.log10(y) : y);
  const xs = curves.flatMap((one) => one.x);
  const ys = curves.flatMap((one) => one.y).filter((y): y is number => y != null && (!log || y > 0)).map(at);
  const extent = (values: number[]): [number, number] => {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
    return low < high ? [low, high] : [low - 1, low + 1];
  };
  const [x0, x1] = extent(xs);
  const [y0, y1] = extent(ys);
  const px = (x: number): string => (left + ((x - x0) / (x1 - x0)) * (width - left - right)).toFixed(1);
  const py = (y: number): string => (height - bottom - ((y - y0) / (y1 - y0)) * (height - top - bottom)).toFixed(1);
  const paths = curves.map((one, i) => {
    let pen = false;
    const d = one.x
      .map((x, n) => {
        const y = one.y[n];
        if (y == null || (log && y <= 0)) {
          pen = false;
          return "";
        }
        const step = one.dots ? `M${px(x)} ${py(at(y))}h0` : `${pen ? "L" : "M"}${px(x)} ${py(at(y))}`;
        pen = true;
        return step;
      })
      .join("");
    const color = COLORS[(one.color ?? i) % 6];
    return `<path d="${d}" fill="none" stroke="${color}" stroke-width="${one.dots ? 4 : 1.8}"${one.dots ? ' stroke-linecap="round"' : one.dashed ? ' stroke-dasharray="6 4"' : ""}/><text x="${left + 10}" y="${top + 16 + 16 * i}" fill="${color}">${escaped(one.name)}</text>`;
  });
  const bounds = limits.map(({ value, severity }) => {
    const color = severity === "error" ? "#b3261e" : "#8a6a00";
    const y = at(value);
    const line = y >= y0 && y <= y1 ? `<path d="M${left} ${py(y)}H${width - right}" stroke="${color}" stroke-width="1.2" stroke-dasharray="4 2"/>` : "";
    return { line, says: `<tspan fill="${color}">${severity === "error" ? "limit" : "warning"} ${numberText(value, 5)}${line ? "" : ", out of sight"}</tspan>` };
  });
  const shares = [0, 0.25, 0.5, 0.75, 1];
  const across = time ? timeTicks(x0, x1, 6) : shares.map((share) => x0 + share * (x1 - x0)).map((at) => ({ at, text: numberText(at, 5) }));
  const ticks = [
    ...across.map(({ at: x, text }) => `<text x="${px(x)}" y="${height - bottom + 18}" text-anchor="middle">${text}</text>`),
    ...shares.map((share) => y0 + share * (y1 - y0)).map((y) => `<text x="${left - 6}" y="${Number(py(y)) + 4}" text-anchor="end">${numberText(log ? 10 ** y : y, 4)}</text>`),
  ];
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12"><rect width="${width}" height="${height}" fill="#fff"/><text x="${left}" y="22" font-size="15" font-weight="600">${escaped(title)}</text><text x="${left}" y="40">${escaped(yLabel)}</text><text x="${width / 2}" y="${height - 12}" text-anchor="middle">${escaped(xLabel)}</text><path d="M${left} ${top}V${height - bottom}H${width - right}" fill="none" stroke="#8792a2"/>${ticks.join("")}${bounds.map((one) => one.line).join("")}${paths.join("")}${bounds.length ? `<text x="${width - right}" y="40" text-anchor="end">${bounds.map((one) => one.says).join(", ")}</text>` : ""}</svg>\n`;
}
