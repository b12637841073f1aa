// Alarms told on the desktop, where the user wants it and the browser allows it.
import { useEffect, useRef } from "react";
import { type Alarm, useAlarms } from "./alarms";
import { prefer, preferences, say, useShared } from "./store";

/** Why this browser can tell nothing; "" where it can. */
export function refusal(): string {
  if (!("Notification" in window)) return "This browser tells nothing on the desktop here: it does so on this machine, and elsewhere over HTTPS.";
  return Notification.permission === "denied" ? "The browser refuses notifications of this page: allow them in its settings." : "";
}

export async function wantNotices(wanted: boolean): Promise<void> {
  const may = wanted && !refusal() && (await Notification.requestPermission()) === "granted";
  prefer({ notices: may });
  if (wanted && !may) say(refusal() || "Notifications were not allowed.", "error");
}

export function useNoticesWanted(): boolean {
  return useShared(preferences).notices && !refusal();
}

/** Tells of alarms that begin while the page is open, whichever page it is; none of those before. */
export function Notices(): null {
  const [found] = useAlarms(20);
  const last = useRef<number | null>(null);
  useEffect(() => {
    if (!found) return;
    const known = last.current;
    const newest = Math.max(0, ...found.alarms.map((one: Alarm) => one.number));
    last.current = Math.max(known ?? 0, newest);
    if (known === null) return;
    for (const one of found.alarms)
      if (one.number > known && one.end == null) {
        const told = new Notification(`${one.severity.toUpperCase()}: ${one.cause}`, { tag: `robophm ${one.number}`, icon: `./icon-${one.severity}.svg` });
        told.onclick = () => {
          window.focus();
          location.hash = "#/alarms";
        };
      }
  }, [found]);
  return null;
}
