import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../../lib/api";
import { sayError, useDesign } from "../../lib/store";
import { Table } from "../../parts/Table";

/** Parts of a robot above which ranges, which take seconds then, are computed when they are asked for. */
const MANY = 120;

const QUANTILES = ["5 %", "50 %", "95 %"];

/** What the figures may be while rates are not exactly known, and whom to ask for what; nothing where all are exact. */
export function Ranges(): ReactNode {
  const design = useDesign();
  const [found, setFound] = useState<Shapes["RobotRanges"] | null>(null);
  const [busy, setBusy] = useState(false);
  const many = Object.keys(design?.levels ?? {}).length > MANY;
  async function compute(signal?: AbortSignal): Promise<void> {
    setBusy(true);
    try {
      setFound(await get("/api/analysis/ranges", {}, signal));
    } catch (error) {
      if (!signal?.aborted) sayError(error);
    }
    setBusy(false);
  }
  useEffect(() => {
    setFound(null);
    if (!design?.valid || many) return;
    const asked = new AbortController();
    void compute(asked.signal);
    return () => asked.abort();
  }, [design?.state, design?.valid, many]);
  if (!design?.valid || (found ? !found.rows.length : !many)) return null;
  return (
    <section className="card" style={{ marginBottom: 16 }}>
      <div className="head" style={{ marginBottom: 4 }}>
        <h2>How sure this is</h2>
        <span className="grow" />
        <button disabled={busy} onClick={() => void compute()}>
          {busy ? "Computing…" : found ? "As of now" : "Compute the ranges"}
        </button>
      </div>
      {found && (
        <>
          <Table label="Ranges of the figures" className="scroll stacked" columns={["Figure", ...QUANTILES.map((one): [string, "number"] => [one, "number"])]}>
            {found.rows.map(([name, ...values]) => (
              <tr key={name}>
                <th scope="row">{name}</th>
                {values.map((one, i) => (
                  <td key={i} className="number" data-label={QUANTILES[i]}>
                    {one}
                  </td>
                ))}
              </tr>
            ))}
          </Table>
          {found.advice.length > 0 && (
            <>
              <h3 style={{ marginTop: 12 }}>What it would help most to know</h3>
              <ol>
                {found.advice.map((one) => (
                  <li key={one}>{one}</li>
                ))}
              </ol>
            </>
          )}
        </>
      )}
    </section>
  );
}
