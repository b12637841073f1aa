import { type ReactNode, useEffect, useState } from "react";
import { post, type Shapes } from "../lib/api";
import { useUnit } from "../lib/store";
import { isValues, type Values } from "../lib/tree";
import { rateText } from "../lib/words";
import { Text } from "./Field";
import { Answer } from "./ModelForm";

interface Variable {
  name: string;
  value: string;
  unit: string;
}

function bare(value: string): number {
  return Number.parseFloat(value.replace(",", "."));
}

/** A component of one's own: named variables and a formula of them. Nothing is evaluated but arithmetic. */
export function FormulaForm({ given, use, done }: { given: Values; use: string; done: (hazard: Values) => void }): ReactNode {
  const shown = useUnit();
  const [formula, setFormula] = useState(String(given.formula ?? ""));
  const [unit, setUnit] = useState(String(given.unit ?? "1/h"));
  const [source, setSource] = useState(String(given.source ?? ""));
  const [variables, setVariables] = useState<Variable[]>(() =>
    isValues(given.variables)
      ? Object.entries(given.variables).map(([name, one]) => ({ name, value: String(isValues(one) ? one.value : one), unit: String((isValues(one) && one.unit) || "") }))
      : [{ name: "base", value: "1e-6", unit: "" }],
  );
  const [answer, setAnswer] = useState<Shapes["RateAnswer"] | null>(null);
  const [wrong, setWrong] = useState("");
  const numbers = Object.fromEntries(variables.filter((one) => one.name).map((one) => [one.name, bare(one.value)]));
  const key = JSON.stringify([formula, unit, numbers]);
  useEffect(() => {
    setAnswer(null);
    if (!formula.trim()) return;
    const bad = variables.find((one) => one.name && !Number.isFinite(bare(one.value)));
    if (bad) {
      setWrong(`${bad.name}: '${bad.value}' is not a number`);
      return;
    }
    const timer = setTimeout(() => {
      post("/api/library/formula", { formula, unit, variables: numbers })
        .then((found) => {
          setAnswer(found);
          setWrong("");
        })
        .catch((error: Error) => setWrong(error.message));
    }, 200);
    return () => clearTimeout(timer);
    // the key says when variables or formula are others; their objects are new at every drawing
  }, [key]);

  const vary = (i: number, change: Partial<Variable>): void => setVariables(variables.map((one, n) => (n === i ? { ...one, ...change } : one)));
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        const said = Object.fromEntries(variables.filter((one) => one.name).map((one) => [one.name, one.unit ? { value: withUnit(one), unit: one.unit } : { value: bare(one.value) }]));
        done({ formula, unit, source, ...(Object.keys(said).length ? { variables: said } : {}) });
      }}
    >
      <Text label="Formula" hint="of numbers, the variables below, + − * / ** and exp log sqrt …" placeholder="base * exp(0.05 * (temperature - 25))" value={formula} set={setFormula} wrong={wrong} />
      <div className="fields">
        <Text label="Unit of its result" hint="1/h, FPMH or FIT" value={unit} set={setUnit} />
        <Text label="Where it is from" value={source} set={setSource} />
      </div>
      <fieldset className="card">
        <legend className="small quiet">Variables: name, value by design, unit (a sensor can be bound to each)</legend>
        {variables.map((one, i) => (
          <div className="row" key={i} style={{ marginBottom: 6 }}>
            <input aria-label={`Name of variable ${i + 1}`} placeholder="name" value={one.name} onChange={(event) => vary(i, { name: event.target.value })} />
            <input aria-label={`Value of ${one.name || `variable ${i + 1}`}`} placeholder="value" value={one.value} onChange={(event) => vary(i, { value: event.target.value })} />
            <input aria-label={`Unit of ${one.name || `variable ${i + 1}`}`} placeholder="unit, e.g. degC" value={one.unit} onChange={(event) => vary(i, { unit: event.target.value })} />
            <button type="button" className="icon" aria-label={`Remove ${one.name || `variable ${i + 1}`}`} onClick={() => setVariables(variables.filter((_, n) => n !== i))}>
              ×
            </button>
          </div>
        ))}
        <button type="button" onClick={() => setVariables([...variables, { name: "", value: "", unit: "" }])}>
          Add a variable
        </button>
      </fieldset>
      {answer && <Answer answer={answer} words={rateText(answer.hazard_rate, shown)} />}
      <div className="row" style={{ marginTop: 10 }}>
        <button className="primary" type="submit" disabled={!answer || !source.trim()}>
          {use}
        </button>
        {!source.trim() && <span className="small quiet">Say where it is from.</span>}
      </div>
    </form>
  );
}

function withUnit(one: Variable): string {
  return /^[-+]?[\d.,]+(e[-+]?\d+)?$/i.test(one.value.trim()) ? `${bare(one.value)} ${one.unit}` : one.value;
}
