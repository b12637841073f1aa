import { type ReactNode, useEffect, useState } from "react";
import { get, post, type Shapes } from "../lib/api";
import { useUnit } from "../lib/store";
import { numberText, rateText } from "../lib/words";
import { Select, Text } from "./Field";

type Input = Shapes["FormInput"];

/** A hazard model as its own description draws it: inputs with units and ranges, and every factor of the answer. */
export function ModelForm({ name, given = {}, use, done }: { name: string; given?: Record<string, string>; use: string; done: (inputs: Record<string, string>) => void }): ReactNode {
  const unit = useUnit();
  const [form, setForm] = useState<Shapes["Form"] | null>(null);
  const [said, setSaid] = useState<Record<string, string>>(given);
  const [answer, setAnswer] = useState<Shapes["RateAnswer"] | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    get("/api/library/models/{name}", { name }).then(setForm).catch((error: Error) => setWrong(error.message));
  }, [name]);

  const inputs = written(form, said);
  const key = JSON.stringify(inputs);
  const missing = form?.inputs.filter((one) => one.required && one.default == null && !inputs[one.name]) ?? [];
  useEffect(() => {
    setAnswer(null);
    if (!form || missing.length) {
      setWrong("");
      return;
    }
    const timer = setTimeout(() => {
      post("/api/library/rate", { model: name, inputs: JSON.parse(key) as Record<string, string> })
        .then((found) => {
          setAnswer(found);
          setWrong("");
        })
        .catch((error: Error) => setWrong(error.message));
    }, 150);
    return () => clearTimeout(timer);
  }, [form, key, missing.length, name]);

  if (!form) return wrong ? <div className="trouble">{wrong}</div> : <p className="quiet">Loading…</p>;
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        if (answer) done(inputs);
      }}
    >
      <h3>{form.title}</h3>
      <p className="small">
        {form.formula} <span className="quiet">{form.source}</span>
      </p>
      <div className="fields">
        {form.inputs.map((one) => (
          <OneInput key={one.name} input={one} value={said[one.name] ?? ""} set={(value) => setSaid({ ...said, [one.name]: value })} />
        ))}
      </div>
      {wrong && (
        <p className="state error" role="alert">
          {wrong.replace(`${name}: `, "")}
        </p>
      )}
      {!answer && missing.length > 0 && <p className="quiet">Still asked for: {missing.map((one) => one.name.replaceAll("_", " ")).join(", ")}.</p>}
      {answer && <Answer answer={answer} words={answer.unit === "1/h" ? rateText(answer.hazard_rate, unit) : `${numberText(answer.hazard_rate)} ${answer.unit}`} />}
      <button className="primary" type="submit" disabled={!answer}>
        {use}
      </button>
    </form>
  );
}

function OneInput({ input, value, set }: { input: Input; value: string; set: (value: string) => void }): ReactNode {
  const label = `${input.name.replaceAll("_", " ")}${input.required && input.default == null ? " *" : ""}`;
  const usual = input.default == null ? "" : `default ${String(input.default)}${input.unit ? ` ${input.unit}` : ""}`;
  if (input.kind === "choice") {
    const options: [string, string][] = [["", input.default == null ? "choose…" : usual], ...input.options.map((one): [string, string] => [one, meaning(one, input)])];
    return <Select label={label} hint={input.description} value={value} set={set} options={options} />;
  }
  if (input.kind === "words") return <Text label={label} hint={input.description} value={value} set={set} />;
  const range = [input.whole ? "a whole number" : "", input.low == null ? "" : `from ${numberText(input.low)}`, input.high == null ? "" : `to ${numberText(input.high)}`].filter(Boolean).join(" ");
  return (
    <Text
      label={`${label}${input.unit ? ` [${input.unit}]` : ""}`}
      hint={[input.description, range, usual].filter(Boolean).join("; ")}
      inputMode={input.whole ? "numeric" : "decimal"}
      placeholder={input.default == null ? "" : String(input.default)}
      value={value}
      set={set}
    />
  );
}

function meaning(option: string, input: Input): string {
  const more = input.meanings[option] ?? Object.entries(input.aliases).filter(([, meant]) => meant === option).map(([said]) => said)[0];
  return more ? `${option}: ${more}` : option;
}

/** A bare number is in the unit that stands beside its field. */
function written(form: Shapes["Form"] | null, said: Record<string, string>): Record<string, string> {
  const found: Record<string, string> = {};
  for (const one of form?.inputs ?? []) {
    const value = said[one.name]?.trim().replace(",", ".");
    if (!value) continue;
    found[one.name] = one.kind === "number" && one.unit && /^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(value) ? `${value} ${one.unit}` : said[one.name]!.trim();
  }
  return found;
}

export function Answer({ answer, words }: { answer: Shapes["RateAnswer"]; words: string }): ReactNode {
  return (
    <div className="card" style={{ margin: "6px 0 12px" }} aria-live="polite">
      <strong style={{ fontSize: "1.25rem" }}>{words}</strong>
      <table>
        <thead>
          <tr>
            <th scope="col">Factor</th>
            <th scope="col" className="number">Value</th>
            <th scope="col">From</th>
          </tr>
        </thead>
        <tbody>
          {answer.factors.map((one, i) => (
            <tr key={i}>
              <th scope="row">{one.symbol}</th>
              <td className="number">{numberText(one.value, 5)}</td>
              <td>{one.note}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
