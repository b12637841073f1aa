import type { ReactNode } from "react";
import type { Shapes } from "../../lib/api";
import { moreText } from "../../lib/words";
import { Table } from "../../parts/Table";

/** Tables as the service words them, and what is to be said of them. */
export function Found({ found }: { found: Shapes["FoundTables"] }): ReactNode {
  return (
    <>
      {found.tables.map((one) => (
        <section className="card" key={one.title}>
          <h2>{one.title}</h2>
          {one.rows.length ? (
            <Table label={one.title} className="scroll stacked" columns={one.columns.map((name, i) => (one.figures.includes(i) ? [name, "number"] : name || ["of", "spoken"]))}>
              {one.rows.map((row, i) => (
                <tr key={i}>
                  {row.map((text, n) => (n === 0 ? <th key={n} scope="row">{text}</th> : <td key={n} data-label={one.columns[n]} className={one.figures.includes(n) ? "number" : undefined}>{text || "–"}</td>))}
                </tr>
              ))}
            </Table>
          ) : (
            <p className="quiet">None.</p>
          )}
          {one.more > 0 && <p className="small quiet">{moreText(one.more)}.</p>}
        </section>
      ))}
      {found.notes.length > 0 && (
        <section className="card">
          {found.notes.map((one) => (
            <p key={one}>{one}</p>
          ))}
        </section>
      )}
    </>
  );
}

export function Trouble({ children }: { children: string }): ReactNode {
  return children ? (
    <div className="trouble" role="alert">
      {children}
    </div>
  ) : null;
}

export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** What is wrong with a time that somebody types; "" where nothing is. */
export const wrongHours = (text: string): string => (text.trim() && hoursOf(text) === undefined ? "expected a number above 0" : "");

export const hoursOf = (text: string): number | undefined => (Number(text.replace(",", ".")) > 0 ? Number(text.replace(",", ".")) : undefined);
