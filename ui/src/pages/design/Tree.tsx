import { type ReactNode, type RefObject, useEffect, useMemo, useRef, useState } from "react";
import type { DesignState } from "../../lib/api";
import { useUnit } from "../../lib/store";
import { everyPart, levelOf, type Part, partOfPlace } from "../../lib/tree";
import { marked, rateText } from "../../lib/words";

interface Row {
  part: Part;
  depth: number;
  /** Which of how many at its place: what is out of sight is not there to be counted. */
  position: number;
  of: number;
}

const HEIGHT = 30; // of a row, as in design.css
const FEW = 200; // rows that are all there; of more those in sight
const AROUND = 20; // rows above and below what is in sight

function* rows(part: Part, open: Set<string>, depth = 0, position = 1, of = 1): Generator<Row> {
  yield { part, depth, position, of };
  if (!open.has(part.path)) return;
  let number = 0;
  for (const one of part.parts) yield* rows(one, open, depth + 1, ++number, part.parts.length);
}

/** Which rows of a list are to be there: all of few, else those in sight. */
function useSight(list: RefObject<HTMLElement | null>, count: number): [number, number] {
  const [sight, setSight] = useState<[number, number]>([0, FEW]);
  useEffect(() => {
    const scroller = list.current;
    if (!scroller) return;
    const look = (): void => {
      const first = Math.max(0, Math.floor(scroller.scrollTop / HEIGHT) - AROUND);
      const last = Math.ceil((scroller.scrollTop + scroller.clientHeight) / HEIGHT) + AROUND;
      setSight((old) => (old[0] === first && old[1] === last ? old : [first, last]));
    };
    const observer = new ResizeObserver(look);
    observer.observe(scroller);
    scroller.addEventListener("scroll", look, { passive: true });
    return () => {
      observer.disconnect();
      scroller.removeEventListener("scroll", look);
    };
  }, [list]);
  return count <= FEW ? [0, count] : sight;
}

/** All that the canvas does can be done from here with the keyboard: choose (Space: several), open, group, rename, delete. */
export function Tree({ root, chosen, choose, open, design }: { root: Part; chosen: string[]; choose: (paths: string[]) => void; open: (part: Part) => void; design: DesignState }): ReactNode {
  const unit = useUnit();
  const [opened, setOpened] = useState<Set<string>>(() => new Set(["", ...root.parts.filter(() => root.parts.length < 30).map((one) => one.path)]));
  const [text, setText] = useState("");
  const list = useRef<HTMLUListElement>(null);
  const focus = chosen[chosen.length - 1] ?? "";

  useEffect(() => {
    setOpened((old) => {
      const next = new Set(old);
      for (const path of chosen) for (let above = levelOf(path); ; above = levelOf(above)) {
        next.add(above);
        if (!above) break;
      }
      return next.size === old.size ? old : next;
    });
  }, [chosen]);

  const wrong = useMemo(() => new Map(design.problems.map((one) => [partOfPlace(one.place), one])), [design]);
  const words = text.toLowerCase();
  const shown = useMemo<Row[]>(() => {
    if (!words) return [...rows(root, opened)];
    const found = [...everyPart(root)].filter((one) => one.path.toLowerCase().includes(words));
    return found.map((part, i) => ({ part, depth: 0, position: i + 1, of: found.length }));
  }, [root, opened, words]);
  const at = shown.findIndex((row) => row.part.path === focus);
  const [first, last] = useSight(list, shown.length);
  const there = shown.map((_, i) => i).slice(first, last);
  if (at >= 0 && (at < first || at >= last)) there.push(at); // whoever comes by keyboard comes to it

  useEffect(() => {
    const scroller = list.current;
    if (!scroller || at < 0) return;
    const top = at * HEIGHT;
    if (top < scroller.scrollTop) scroller.scrollTop = top;
    else if (top + HEIGHT > scroller.scrollTop + scroller.clientHeight) scroller.scrollTop = top + HEIGHT - scroller.clientHeight;
  }, [at]);

  function toggle(part: Part, on: boolean): void {
    setOpened((old) => {
      const next = new Set(old);
      if (on) next.add(part.path);
      else next.delete(part.path);
      return next;
    });
  }

  function move(row: Row | undefined, add: boolean): void {
    if (!row) return;
    choose(add ? [...chosen.filter((path) => path !== row.part.path), row.part.path] : [row.part.path]);
    requestAnimationFrame(() => list.current?.querySelector<HTMLElement>('[tabindex="0"]')?.focus());
  }

  function key(event: React.KeyboardEvent, row: Row): void {
    const { part } = row;
    if (event.key === "ArrowDown") move(shown[at + 1], event.shiftKey);
    else if (event.key === "ArrowUp") move(shown[at - 1], event.shiftKey);
    else if (event.key === "Home") move(shown[0], false);
    else if (event.key === "End") move(shown[shown.length - 1], false);
    else if (event.key === "ArrowRight" && part.parts.length && !opened.has(part.path)) toggle(part, true);
    else if (event.key === "ArrowLeft" && opened.has(part.path) && part.parts.length) toggle(part, false);
    else if (event.key === "ArrowLeft") move(shown.find((one) => one.part.path === levelOf(part.path)), false);
    else if (event.key === " ") pick(part, true);
    else if (event.key === "Enter") open(part);
    else return;
    event.preventDefault();
  }

  function pick(part: Part, add: boolean): void {
    if (!add) choose([part.path]);
    else if (chosen.includes(part.path) && chosen.length > 1) choose(chosen.filter((path) => path !== part.path));
    else choose([...chosen.filter((path) => path), part.path]);
  }

  return (
    <>
      <input type="search" aria-label="Find in the tree" placeholder="Find a part" value={text} onChange={(event) => setText(event.target.value)} />
      <ul role="tree" aria-multiselectable="true" aria-label="Parts" ref={list} className="tree">
        <li role="none" style={{ height: HEIGHT * shown.length }} />
        {there.map((i) => {
          const row = shown[i]!;
          const { part } = row;
          const figures = design.levels[part.path];
          const problem = wrong.get(part.path);
          const focused = at < 0 ? i === 0 : i === at;
          return (
            <li
              key={part.path}
              role="treeitem"
              aria-selected={chosen.includes(part.path)}
              aria-level={row.depth + 1}
              aria-posinset={row.position}
              aria-setsize={row.of}
              aria-expanded={part.parts.length && !words ? opened.has(part.path) : undefined}
              tabIndex={focused ? 0 : -1}
              onKeyDown={(event) => key(event, row)}
              onClick={(event) => pick(part, event.ctrlKey || event.metaKey || event.shiftKey)}
              onDoubleClick={() => open(part)}
              style={{ top: HEIGHT * i, paddingLeft: 6 + 14 * row.depth }}
              title={part.path}
              data-level={part.kind === "component" ? levelOf(part.path) : part.path}
            >
              <span
                className="twist"
                aria-hidden="true"
                onClick={(event) => {
                  event.stopPropagation();
                  toggle(part, !opened.has(part.path));
                }}
              >
                {part.parts.length ? (opened.has(part.path) ? "▾" : "▸") : ""}
              </span>
              <span className={`name ${part.kind}`}>{words ? part.path : part.name}</span>
              {problem && <span className={`badge ${problem.level}`}>{problem.level === "error" ? "mend" : "odd"}</span>}
              {figures && figures.quantity > 1 && <span className="small quiet">×{figures.quantity}</span>}
              <span className="small quiet rate">{figures ? marked(design.unknown[part.path], "hazard_rate", rateText(figures.hazard_rate, unit)) : ""}</span>
            </li>
          );
        })}
      </ul>
    </>
  );
}
