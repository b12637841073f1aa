import type { ReactNode } from "react";

export interface Bar {
  name: string;
  values: (number | null)[];
  words: string;
  /** Where its name leads. */
  href?: string;
}

function Linked({ href, children }: { href?: string; children: ReactNode }): ReactNode {
  return href ? <a href={href}>{children}</a> : children;
}

/** Bars of a few values, one or two of each, from zero to the largest. */
export function Bars({ bars, names, title }: { bars: Bar[]; names: string[]; title: string }): ReactNode {
  const most = Math.max(...bars.flatMap((bar) => bar.values.map((value) => value ?? 0)), 0) || 1;
  const thick = 10;
  const step = thick * names.length + 12;
  const left = 230;
  const room = 260;
  const top = names.length > 1 ? 26 : 6;
  return (
    <svg className="bars" viewBox={`0 0 640 ${top + step * bars.length}`} role={bars.some((bar) => bar.href) ? "group" : "img"} aria-label={`${title}: ${bars.map((bar) => `${bar.name} ${bar.words}`).join("; ")}`}>
      {names.length > 1 &&
        names.map((name, i) => (
          <g key={name} transform={`translate(${left + i * 110} 4)`}>
            <rect className={"ab"[i]} width="10" height="10" />
            <text x="16" y="10">
              {name}
            </text>
          </g>
        ))}
      {bars.map((bar, row) => (
        <g key={bar.name} transform={`translate(0 ${top + row * step})`}>
          <Linked href={bar.href}>
            <text x={left - 10} y={(thick * names.length) / 2 + 4} textAnchor="end">
              {bar.name.length > 34 ? `…${bar.name.slice(-33)}` : bar.name}
              <title>{bar.name}</title>
            </text>
          </Linked>
          {bar.values.map((value, i) => value != null && <rect key={i} className={"ab"[i]} x={left} y={i * thick} width={Math.max((value / most) * room, 1)} height={thick - 1} />)}
          <text className="quiet" x={left + room + 10} y={(thick * names.length) / 2 + 4}>
            {bar.words}
          </text>
        </g>
      ))}
    </svg>
  );
}
