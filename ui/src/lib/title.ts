// What a tab that nobody looks at says of the robot: its title and its icon.
import { useEffect } from "react";
import { useHealth } from "./health";
import { pulse } from "./live";
import { useShared } from "./store";

const ALARMING = ["error", "warn", "stale"];
const NO_LONGER: Record<string, string> = { stopped: "stopped", ended: "recording over", failed: "watching failed" };

/** What is not well, and that nothing is watched any more, stands first in the title, and is the icon. */
export function useTitle(page: string, name: string | undefined): void {
  const { health } = useHealth();
  const { monitoring } = useShared(pulse);
  const state = health?.state ?? "idle";
  useEffect(() => {
    const alarming = ALARMING.filter((one) => one === state);
    const over = NO_LONGER[monitoring];
    const said = [...alarming, ...(over ? [over] : [])];
    const icon = alarming[0] ?? (monitoring === "failed" ? "error" : over && "stopped");
    document.title = `${said.length ? `${said.join(", ").toUpperCase()} – ` : ""}${page} – ${name ?? "robophm"}`;
    document.querySelector("link[rel=icon]")?.setAttribute("href", icon ? `./icon-${icon}.svg` : "./icon.svg");
  }, [state, monitoring, page, name]);
}
