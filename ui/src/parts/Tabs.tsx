import { type ReactNode, useEffect, useRef } from "react";

export function Tabs({ label, tabs, chosen, choose }: { label: string; tabs: [string, string][]; chosen: string; choose: (id: string) => void }): ReactNode {
  const list = useRef<HTMLDivElement>(null);
  useEffect(() => {
    // Where they are in one row that is longer than the screen is wide; the page itself stays where it is.
    const one = list.current?.querySelector<HTMLElement>('[aria-selected="true"]');
    if (one && list.current) list.current.scrollLeft = one.offsetLeft - (list.current.clientWidth - one.offsetWidth) / 2;
  }, [chosen]);
  return (
    <div className="tabs" role="tablist" aria-label={label} ref={list}>
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
