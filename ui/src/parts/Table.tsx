import type { ReactNode } from "react";

/** A column's name; of a column of figures, or one whose name is only spoken, also which it is. */
export type Column = string | [name: string, kind: "number" | "spoken"];

/** A table that scrolls in itself where it is too wide. */
export function Table({ label, columns, caption, className = "scroll", children }: { label: string; columns: Column[]; caption?: ReactNode; className?: string; children: ReactNode }): ReactNode {
  return (
    <div className={className} tabIndex={0} role="region" aria-label={label}>
      <table>
        {caption && <caption>{caption}</caption>}
        <thead>
          <tr>
            {columns.map((one) => {
              const [name, kind] = typeof one === "string" ? [one, ""] : one;
              return (
                <th key={name} scope="col" className={kind === "number" ? "number" : undefined}>
                  {kind === "spoken" ? <span className="hidden">{name}</span> : name}
                </th>
              );
            })}
          </tr>
        </thead>
        <tbody>{children}</tbody>
      </table>
    </div>
  );
}

const MOST = 500;

/** What a file would become, as the service says it. */
export function Preview({ label, caption, className, columns, rows }: { label: string; caption?: ReactNode; className?: string; columns: string[]; rows: string[][] }): ReactNode {
  return (
    <Table label={label} caption={caption} className={className} columns={columns}>
      {rows.slice(0, MOST).map((row, i) => (
        <tr key={i}>
          {row.map((one, n) => (
            <td key={n}>{one}</td>
          ))}
        </tr>
      ))}
    </Table>
  );
}
