import { type InputHTMLAttributes, type ReactNode, useEffect, useId, useRef, useState } from "react";

interface Common {
  label: string;
  hint?: string;
  wrong?: string;
  /** Whether the label is only spoken. */
  spoken?: boolean;
}

function Frame({ id, label, hint, wrong, spoken, children }: Common & { id: string; children: ReactNode }): ReactNode {
  return (
    <div className="field">
      <label htmlFor={id} className={spoken ? "hidden" : undefined}>{label}</label>
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

export function Text({ label, hint, wrong, spoken, value, set, ...more }: TextProps): ReactNode {
  const id = useId();
  const says = [hint && `${id}-hint`, wrong && `${id}-wrong`].filter(Boolean).join(" ");
  return (
    <Frame id={id} label={label} hint={hint} wrong={wrong} spoken={spoken}>
      <input id={id} value={value} aria-describedby={says || undefined} aria-invalid={wrong ? true : undefined} onChange={(event) => set(event.target.value)} {...more} />
    </Frame>
  );
}

export interface Typing {
  text: string;
  type: (text: string) => void;
  finish: () => void;
  drop: () => void;
  /** What has become of the value since typing began; "" where it is as it was. */
  meanwhile: string;
}

/** What is typed counts when it is finished: on Enter, or when the field is left. It stays whatever others edit. */
export function useTyping(value: string, set: (value: string) => void): Typing {
  /** What is typed, the value that it was begun at, and whether it is finished: then the next value takes its place. */
  const [typed, setTyped] = useState<{ text: string; at: string; finished: boolean } | null>(null);
  useEffect(() => setTyped((now) => (now?.finished ? null : now)), [value]);
  return {
    text: typed?.text ?? value,
    type: (text) => setTyped({ text, at: typed && !typed.finished ? typed.at : value, finished: false }),
    finish: () => {
      if (!typed || typed.finished) return;
      setTyped({ ...typed, at: value, finished: true });
      if (typed.text !== value) set(typed.text);
    },
    drop: () => setTyped(null),
    meanwhile: typed && typed.at !== value ? `Changed meanwhile to ${value || "nothing"}; Escape takes that.` : "",
  };
}

export function Entry({ value, set, ...more }: TextProps): ReactNode {
  const typing = useTyping(value, set);
  return (
    <Text
      {...more}
      wrong={more.wrong || typing.meanwhile}
      value={typing.text}
      set={typing.type}
      onBlur={typing.finish}
      onKeyDown={(event) => {
        if (event.key === "Enter") typing.finish();
        if (event.key === "Escape") typing.drop();
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

export function FileButton({ label, accept, take, several }: { label: string; accept?: string; take?: (file: File) => void; several?: (files: File[]) => void }): ReactNode {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" onClick={() => input.current?.click()}>
        {label}
      </button>
      <input
        ref={input}
        aria-label={label}
        hidden
        type="file"
        accept={accept}
        multiple={several !== undefined}
        onChange={(event) => {
          const files = [...(event.target.files ?? [])];
          if (files.length) several?.(files);
          if (files[0]) take?.(files[0]);
          event.target.value = "";
        }}
      />
    </>
  );
}
