import { type InputHTMLAttributes, type ReactNode, useEffect, useId, useState } from "react";

interface Common {
  label: string;
  hint?: string;
  wrong?: string;
}

function Frame({ id, label, hint, wrong, children }: Common & { id: string; children: ReactNode }): ReactNode {
  return (
    <div className="field">
      <label htmlFor={id}>{label}</label>
      {children}
      {hint && (
        <span className="hint" id={`${id}-hint`}>
          {hint}
        </span>
      )}
      {wrong && (
        <span className="wrong" id={`${id}-wrong`} role="alert">
          {wrong}
        </span>
      )}
    </div>
  );
}

type TextProps = Common & { value: string; set: (value: string) => void } & Omit<InputHTMLAttributes<HTMLInputElement>, "value" | "onChange">;

export function Text({ label, hint, wrong, value, set, ...more }: TextProps): ReactNode {
  const id = useId();
  const says = [hint && `${id}-hint`, wrong && `${id}-wrong`].filter(Boolean).join(" ");
  return (
    <Frame id={id} label={label} hint={hint} wrong={wrong}>
      <input id={id} value={value} aria-describedby={says || undefined} aria-invalid={wrong ? true : undefined} onChange={(event) => set(event.target.value)} {...more} />
    </Frame>
  );
}

/** What is typed counts when it is finished: on Enter, or when the field is left. */
export function Entry({ value, set, ...more }: TextProps): ReactNode {
  const [text, setText] = useState(value);
  useEffect(() => setText(value), [value]);
  const finish = (): void => {
    if (text !== value) set(text);
  };
  return (
    <Text
      {...more}
      value={text}
      set={setText}
      onBlur={finish}
      onKeyDown={(event) => {
        if (event.key === "Enter") finish();
        if (event.key === "Escape") setText(value);
      }}
    />
  );
}

export function Select({ label, hint, wrong, value, set, options, disabled }: Common & { value: string; set: (value: string) => void; options: (readonly [string, string])[]; disabled?: boolean }): ReactNode {
  const id = useId();
  return (
    <Frame id={id} label={label} hint={hint} wrong={wrong}>
      <select id={id} value={value} disabled={disabled} onChange={(event) => set(event.target.value)}>
        {options.map(([key, name]) => (
          <option key={key} value={key}>
            {name}
          </option>
        ))}
      </select>
    </Frame>
  );
}

export function Area({ label, hint, wrong, value, set, rows = 8 }: Common & { value: string; set: (value: string) => void; rows?: number }): ReactNode {
  const id = useId();
  return (
    <Frame id={id} label={label} hint={hint} wrong={wrong}>
      <textarea id={id} rows={rows} spellCheck={false} value={value} onChange={(event) => set(event.target.value)} />
    </Frame>
  );
}

export function Check({ label, value, set }: { label: string; value: boolean; set: (value: boolean) => void }): ReactNode {
  const id = useId();
  return (
    <div className="check">
      <input id={id} type="checkbox" checked={value} onChange={(event) => set(event.target.checked)} />
      <label htmlFor={id}>{label}</label>
    </div>
  );
}

export function FileButton({ label, accept, take }: { label: string; accept: string; take: (file: File) => void }): ReactNode {
  const id = useId();
  return (
    <>
      <label className="button" htmlFor={id} tabIndex={0} role="button" onKeyDown={(event) => {
          if (event.key !== "Enter" && event.key !== " ") return;
          event.preventDefault(); // else the space bar chooses once more when it is let go
          document.getElementById(id)?.click();
        }}>
        {label}
      </label>
      <input
        id={id}
        className="hidden"
        type="file"
        tabIndex={-1}
        accept={accept}
        onChange={(event) => {
          const file = event.target.files?.[0];
          if (file) take(file);
          event.target.value = "";
        }}
      />
    </>
  );
}
