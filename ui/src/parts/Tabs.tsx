import type { ReactNode } from "react";

export function Tabs({ label, tabs, chosen, choose }: { label: string; tabs: [string, string][]; chosen: string; choose: (id: string) => void }): ReactNode {
  return (
    <div className="tabs" role="tablist" aria-label={label}>
      {tabs.map(([id, name], i) => (
        <button
          key={id}
          role="tab"
          aria-selected={id === chosen}
          tabIndex={id === chosen ? 0 : -1}
          onClick={() => choose(id)}
          onKeyDown={(event) => {
            const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
            if (!step) return;
            choose(tabs[(i + step + tabs.length) % tabs.length]![0]);
            const beside = event.currentTarget.parentElement?.children[(i + step + tabs.length) % tabs.length];
            (beside as HTMLElement | undefined)?.focus();
          }}
        >
          {name}
        </button>
      ))}
    </div>
  );
}
