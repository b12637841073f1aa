import { type ReactNode, useEffect, useMemo, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { ModelForm } from "./ModelForm";

const BOOKS: Record<string, string> = { mil_hdbk_217f: "MIL-HDBK-217F", nswc_11: "NSWC-11", general: "General" };

/** All models; the chosen one as a form. */
export function Library({ start = "", given, use, done }: { start?: string; given?: Record<string, string>; use: string; done: (model: string, inputs: Record<string, string>) => void }): ReactNode {
  const [models, setModels] = useState<Shapes["ModelName"][]>([]);
  const [text, setText] = useState("");
  const [chosen, setChosen] = useState(start);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    get("/api/library")
      .then((found) => setModels(found.models))
      .catch((error: unknown) => setWrong(String(error instanceof Error ? error.message : error)));
  }, []);
  const found = useMemo(() => {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    return models.filter((one) => words.every((word) => `${one.name} ${one.title}`.toLowerCase().replaceAll("_", " ").includes(word)));
  }, [models, text]);
  if (wrong) return <div className="trouble" role="alert">{wrong}</div>;
  return (
    <div className="library">
      <div>
        <input type="search" aria-label="Find a model" placeholder="Find a model: motor, capacitor, spring…" value={text} onChange={(event) => setText(event.target.value)} />
        <select size={12} aria-label="Models" value={chosen} onChange={(event) => setChosen(event.target.value)}>
          {Object.entries(BOOKS).map(([book, name]) => {
            const inside = found.filter((one) => one.handbook === book);
            return (
              inside.length > 0 && (
                <optgroup key={book} label={name}>
                  {inside.map((one) => (
                    <option key={one.name} value={one.name}>
                      {one.name.slice(one.name.indexOf(".") + 1).replaceAll("_", " ").replaceAll(".", ": ")}
                    </option>
                  ))}
                </optgroup>
              )
            );
          })}
        </select>
        <p className="small quiet">{found.length} of {models.length} models</p>
      </div>
      <div>{chosen ? <ModelForm key={chosen} name={chosen} given={chosen === start ? given : undefined} use={use} done={(inputs) => done(chosen, inputs)} /> : <p className="quiet">Choose a model: its form asks for what the handbook asks for, and shows every factor of the answer.</p>}</div>
    </div>
  );
}
