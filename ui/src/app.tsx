import { Component, type ReactNode, useEffect, useState } from "react";
import { useAsking, useHealth } from "./lib/health";
import { pulse } from "./lib/live";
import { go, own, preferences, redo, route, save, undo, useDesign, useShared } from "./lib/store";
import { Help } from "./parts/Help";
import { Icon, State } from "./parts/Icon";
import { OnlyFor } from "./parts/OnlyFor";
import { OutsideDialog } from "./parts/OutsideDialog";
import { Palette } from "./parts/Palette";
import { PastButton } from "./parts/Past";
import { ProblemsButton } from "./parts/Problems";
import { Toasts } from "./parts/Toasts";
import { MONITORING } from "./parts/Watching";
import { User } from "./parts/User";
import { Unreachable } from "./parts/Unreachable";
import { PAGES } from "./pages";
import { Notices, useNoticesWanted } from "./lib/notices";
import { useTitle } from "./lib/title";

/** One page that fails does not take the others with it. */
class Fence extends Component<{ children: ReactNode; of: string }, { wrong: string }> {
  state = { wrong: "" };
  static getDerivedStateFromError(error: unknown): { wrong: string } {
    return { wrong: error instanceof Error ? error.message : String(error) };
  }
  render(): ReactNode {
    if (!this.state.wrong) return this.props.children;
    return (
      <div className="trouble" role="alert">
        <h2>This page has failed</h2>
        <p>{this.state.wrong}</p>
        <button onClick={() => this.setState({ wrong: "" })}>Try again</button>
      </div>
    );
  }
}

function Top({ openPalette, openHelp }: { openPalette: () => void; openHelp: () => void }): ReactNode {
  const design = useDesign();
  const { monitoring } = useShared(pulse);
  const { health } = useHealth();
  const mine = useShared(own);
  const undoes = mine.done.at(-1)?.what ?? design?.undo;
  const redoes = mine.undone.at(-1)?.what ?? design?.redo;
  return (
    <header className="top">
      <div className="brand">
        <img src="./icon.svg" alt="" />
        <span>{design?.name ?? "robophm"}</span>
      </div>
      <span className="quiet small file">
        {design ? (design.saved ? `${design.file}, saved` : `${design.file}, not saved`) : "…"}
      </span>
      <span className="grow" />
      <span className={`state ${monitoring === "running" ? "ok" : monitoring === "failed" ? "error" : "idle"}`} role="status">
        <Icon name={monitoring === "running" ? "live" : "pause"} />
        {MONITORING[monitoring] ?? "Not watching"}
      </span>
      {health && health.state !== "idle" && (
        <a className="health" href="#/overview">
          <span className="hidden">Health: </span>
          <State of={health.state} limited={health.limits_set} title={health.why.join("\n") || undefined} />
        </a>
      )}
      <User />
      <ProblemsButton />
      <PastButton />
      <OnlyFor role="editor">
        <button onClick={() => void undo()} disabled={undoes == null} title={undoes == null ? "Nothing to undo" : `Undo: ${undoes} (Ctrl+Z)`}>
          Undo
        </button>
        <button onClick={() => void redo()} disabled={redoes == null} title={redoes == null ? "Nothing to redo" : `Redo: ${redoes} (Ctrl+Y)`}>
          Redo
        </button>
        <button className={design && !design.saved ? "primary" : ""} onClick={() => void save()} disabled={!design || design.saved} title="Ctrl+S">
          Save
        </button>
      </OnlyFor>
      <button className="icon" onClick={openPalette} aria-label="Find anything (Ctrl+K)">
        <Icon name="search" />
      </button>
      <button className="icon" onClick={openHelp} aria-label="Help (?)">
        ?
      </button>
    </header>
  );
}

export function App(): ReactNode {
  useAsking();
  const { page } = useShared(route);
  const { times } = useShared(preferences);
  const { outside: changedOutside } = useShared(pulse);
  const design = useDesign();
  const notices = useNoticesWanted();
  const [palette, setPalette] = useState(false);
  const [help, setHelp] = useState(false);
  const shown = PAGES.find((one) => one.id === page) ?? PAGES[0]!;

  useTitle(shown.name, design?.name);

  useEffect(() => {
    function key(event: KeyboardEvent): void {
      const target = event.target as HTMLElement;
      const typing = /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName);
      const control = event.ctrlKey || event.metaKey;
      const low = event.key.toLowerCase();
      if (control && low === "s") void save();
      else if (control && low === "k") setPalette(true);
      else if (control && !typing && low === "z" && !event.shiftKey) void undo();
      else if (control && !typing && (low === "y" || (low === "z" && event.shiftKey))) void redo();
      else if (!typing && !control && event.key === "/") setPalette(true);
      else if (!typing && !control && event.key === "?") setHelp(true);
      else return;
      event.preventDefault();
    }
    addEventListener("keydown", key);
    return () => removeEventListener("keydown", key);
  }, []);

  useEffect(() => {
    document.querySelector(".rail [aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" }); // on a telephone they stand in a row
  }, [shown.id]);

  const Show = shown.show;
  return (
    <div className="shell">
      <a className="skip" href="#main" onClick={(event) => { event.preventDefault(); document.getElementById("main")?.focus(); }}>
        To the content
      </a>
      <Top openPalette={() => setPalette(true)} openHelp={() => setHelp(true)} />
      <nav className="rail" aria-label="Pages">
        {PAGES.map((one) => (
          <a key={one.id} href={`#/${one.id}`} aria-current={one.id === shown.id ? "page" : undefined} title={one.name}>
            <Icon path={one.icon} />
            <span>{one.name}</span>
          </a>
        ))}
      </nav>
      <main id="main" tabIndex={-1} className={shown.flush ? "flush" : ""}>
        <Unreachable />
        {changedOutside && (
          <div className="trouble" role="alert">
            <strong>{design?.file} was changed by hand</strong> while there are edits here that are not saved, or it is no
            design as it stands. Nothing is lost: <button onClick={() => void save()}>See what was changed</button>
          </div>
        )}
        <Fence of={shown.id} key={`${shown.id} ${times}`}>
          {design ? <Show /> : <p className="quiet">Loading the design…</p>}
        </Fence>
      </main>
      <Toasts />
      {notices && <Notices />}
      <OutsideDialog />
      {palette && <Palette close={() => setPalette(false)} pages={PAGES} go={go} />}
      {help && <Help close={() => setHelp(false)} />}
    </div>
  );
}
