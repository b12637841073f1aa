import type { ReactNode } from "react";

export interface Bar {
  name: string;
  values: (number | null)[];
  words: string;
  /** Where its name leads. */
  href?: string;
}

/** Bars of a few values, one or two of each, from zero to the largest. */
export function Bars({ bars, names, title }: { bars: Bar[]; names: string[]; title: string }): ReactNode {
  const most = Math.max(...bars.flatMap((bar) => bar.values.map((value) => value ?? 0)), 0) || 1;
  return (
    <>
      {names.length > 1 && (
        <p className="small row">
          {names.map((name, i) => (
            <span key={name} className="row">
              <i className={`key ${"ab"[i]}`} /> {name}
            </span>
          ))}
        </p>
      )}
      <ol className="bars" aria-label={title}>
        {bars.map((bar) => (
          <li key={bar.name}>
            {bar.href ? <a href={bar.href}>{bar.name}</a> : <span>{bar.name}</span>}
            <span>
              {bar.values.map((value, i) => value != null && <i key={i} className={"ab"[i]} style={{ width: `${(100 * value) / most}%` }} />)}
            </span>
            <span className="number">{bar.words}</span>
          </li>
        ))}
      </ol>
    </>
  );
}
