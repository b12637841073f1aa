import type { ReactNode } from "react";

/** What is changed in a text, line by line. */
export function Changed({ label, lines }: { label: string; lines: string[] }): ReactNode {
  return (
    <pre className="changes" tabIndex={0} aria-label={label}>
      {lines.map((line, i) => (
        <span key={i} className={line.startsWith("+") ? "added" : line.startsWith("-") ? "removed" : ""}>
          {`${line}\n`}
        </span>
      ))}
    </pre>
  );
}
