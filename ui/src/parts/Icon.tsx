import type { ReactNode } from "react";

/** Drawn on 24 × 24, in strokes. */
export const ICONS = {
  pulse: "M3 13h4l2-7 4 13 3-9 2 3h3",
  diagram: "M3 9h5v6H3zM16 4h5v6h-5zM16 14h5v6h-5zM8 12h4M12 7v10M12 7h4M12 17h4",
  parts: "M4 5h16M4 10h16M4 15h16M4 20h16M9 5v15",
  curve: "M4 4v16h16M6 7c5 0 6 10 13 11",
  live: "M12 12m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0M7 7a7 7 0 0 0 0 10M17 7a7 7 0 0 1 0 10",
  sensor: "M12 3v9M12 12a4 4 0 1 0 .01 0M9 6h2M9 9h2",
  task: "M5 6l2 2 3-4M5 13l2 2 3-4M13 6h7M13 13h7M13 20h7M5 20h4",
  report: "M6 3h9l4 4v14H6zM15 3v4h4M9 12h7M9 16h7",
  add: "M4 8h9v9H4zM8 17v3M8 8V5M18 3v8M14 7h8",
  settings: "M4 7h9M17 7h3M4 17h3M11 17h9M13 5v4M7 15v4",
  bell: "M6 17V11a6 6 0 0 1 12 0v6l2 2H4zM10 21h4",
  search: "M11 11m-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0M16 16l5 5",
  pause: "M8 5v14M16 5v14",
  ok: "M4 13l5 5L20 6",
  warn: "M12 3L22 20H2zM12 10v4M12 17v.5",
  error: "M5 5l14 14M19 5L5 19",
  stale: "M12 3a9 9 0 1 0 .01 0M12 7v5l3 3",
  idle: "M12 3a9 9 0 1 0 .01 0M8 12h8",
} as const;

export function Icon(of: { name: keyof typeof ICONS } | { path: string }): ReactNode {
  return (
    <svg viewBox="0 0 24 24" width="18" height="18" fill="none" stroke="currentColor" strokeWidth="2" strokeLinecap="round" strokeLinejoin="round" aria-hidden="true" focusable="false">
      <path d={"path" in of ? of.path : ICONS[of.name]} />
    </svg>
  );
}

const WORDS = { ok: "OK", warn: "WARN", error: "ERROR", stale: "STALE", idle: "NOT WATCHED" } as const;

/** In one word; where no limit is set nothing can be called well. */
export function State({ of, limited = true, title }: { of: keyof typeof WORDS; limited?: boolean; title?: string }): ReactNode {
  const shown = of === "ok" && !limited ? "idle" : of;
  return (
    <span className={`state ${shown}`} title={title}>
      <Icon name={shown} />
      {shown === of ? WORDS[of] : "NO LIMITS SET"}
    </span>
  );
}
