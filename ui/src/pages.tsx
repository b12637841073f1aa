import { type ComponentType, type ReactNode, useEffect, useState } from "react";
import { route } from "./lib/store";

/** What a file of pages/ says of itself as `page`; what it shows is its default export. */
export interface About {
  name: string;
  /** A path on 24 × 24, drawn in strokes. */
  icon: string;
  /** Its place among the pages. */
  order: number;
  /** Without a margin. */
  flush?: boolean;
}

export interface Page extends About {
  /** What its address is: its file's name in small letters. */
  id: string;
  show: ComponentType;
}

// Each file comes twice: what it says of itself at once (vite.config.ts takes that out), what it shows when that is asked for.
const ABOUT = import.meta.glob<About>("./pages/*.tsx", { eager: true, import: "page", query: "?about" });
const SHOWN = import.meta.glob<ComponentType>("./pages/*.tsx", { import: "default" });

/** A page that is loaded when it is first asked for; at once, beside the design, where the address asks.
 * Not React's lazy, which shows its fallback for 300 ms at least. */
function later(load: () => Promise<ComponentType>, now: boolean): ComponentType {
  let loaded: ComponentType | undefined;
  const begin = async (): Promise<void> => void (loaded = await load());
  let under = now ? begin() : undefined;
  under?.catch(() => (under = undefined));
  return function Later(): ReactNode {
    const [state, setState] = useState<{ wrong?: Error }>({});
    useEffect(() => {
      if (!loaded) (under ?? begin()).then(() => setState({}), (wrong: Error) => setState({ wrong }));
    }, []);
    if (state.wrong) throw state.wrong;
    const Loaded = loaded;
    return Loaded ? <Loaded /> : <p className="quiet">Loading…</p>;
  };
}

function found(): Page[] {
  const asked = route.get().page;
  const idOf = (file: string): string => file.replace(/^.*\/|\.tsx$/g, "").toLowerCase();
  const pages = Object.entries(ABOUT).map(([file, about]) => ({ file, id: idOf(file), about }));
  pages.sort((one, other) => one.about.order - other.about.order || one.id.localeCompare(other.id));
  const first = pages.some((one) => one.id === asked) ? asked : pages[0]!.id;
  return pages.map(({ file, id, about }) => ({ ...about, id, show: later(SHOWN[file]!, id === first) }));
}

export const PAGES = found();
