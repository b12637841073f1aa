// Live values over one WebSocket: see the service's streaming module for how a frame is made.
import { useEffect, useSyncExternalStore } from "react";
import { design, refresh, Shared, unreachable } from "./store";

export interface Points {
  times: number[];
  values: number[];
}

/** A span of time without a value; it has no end while it lasts. */
export type Gap = [from: number, to: number | null];

interface Header {
  kind: "batch" | "history";
  id?: number;
  series: [string, number][];
  gaps?: Record<string, Gap[]>;
  now?: number;
  monitoring: string;
  looks: number;
  revision: number;
  /** Whether the design's file was changed by hand, and could not be taken in. */
  outside: boolean;
}

const MOST = 40000;
export const connected = new Shared<"connecting" | "open" | "lost">("connecting");
/** Of monitoring: its state, and how often figures were made; and whether the file was changed by hand. */
export const pulse = new Shared<{ monitoring: string; looks: number; outside: boolean }>({ monitoring: "idle", looks: 0, outside: false });

class Live {
  private socket: WebSocket | null = null;
  private wanted = new Map<string, number>();
  private series = new Map<string, Points>();
  private silences = new Map<string, Gap[]>();
  private waiting = new Map<number, (points: Points) => void>();
  private listeners = new Set<() => void>();
  private delay = 500;
  private nextId = 1;
  private seconds = 60;
  version = 0;
  /** The newest time that the robot, or its clock, told of. */
  now = -Infinity;

  connect(): void {
    const url = new URL("./api/live", location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    url.hash = "";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.delay = 500;
      connected.set("open");
      this.series.clear();
      this.silences.clear();
      this.tell();
      void refresh().then(() => (unreachable.get() ? refresh() : undefined)); // one that was under way may have failed
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.take(event.data);
    socket.onclose = () => {
      connected.set("lost");
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(this.delay * 2, 8000);
    };
    this.socket = socket;
  }

  private take(frame: ArrayBuffer): void {
    const length = new DataView(frame).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(frame, 4, length))) as Header;
    let at = 4 + length;
    for (const [name, count] of header.series) {
      const times = new Float64Array(frame, at, count);
      const values = new Float64Array(frame, at + 8 * count, count);
      at += 16 * count;
      if (header.kind === "history") this.waiting.get(header.id ?? 0)?.({ times: [...times], values: [...values] });
      else this.append(name, times, values);
    }
    if (header.kind === "history") this.waiting.delete(header.id ?? 0);
    const now = pulse.get();
    if (now.monitoring !== header.monitoring || now.looks !== header.looks || now.outside !== header.outside)
      pulse.set({ monitoring: header.monitoring, looks: header.looks, outside: header.outside });
    const shown = design.get();
    if (shown && header.revision > shown.revision) void refresh();
    const gaps = Object.entries(header.gaps ?? {});
    for (const [name, found] of gaps) this.silences.set(name, found);
    this.now = header.now ?? this.now;
    if ((header.series.length || gaps.length) && header.kind === "batch") {
      this.version += 1;
      this.listeners.forEach((listener) => listener());
    }
  }

  private append(name: string, times: Float64Array, values: Float64Array): void {
    let points = this.series.get(name);
    if (!points || (times.length && points.times.length && times[0]! < points.times[points.times.length - 1]!)) {
      points = { times: [], values: [] };
      this.series.set(name, points);
    }
    for (let i = 0; i < times.length; i++) {
      points.times.push(times[i]!);
      points.values.push(values[i]!);
    }
    if (points.times.length > MOST) {
      points.times.splice(0, points.times.length - MOST / 2);
      points.values.splice(0, points.values.length - MOST / 2);
    }
  }

  private tell(): void {
    if (this.socket?.readyState === WebSocket.OPEN)
      this.socket.send(JSON.stringify({ watch: [...this.wanted.keys()], seconds: this.seconds, pixels: 1200 }));
  }

  watch(names: string[], seconds: number): () => void {
    this.seconds = Math.max(seconds, 1);
    for (const name of names) this.wanted.set(name, (this.wanted.get(name) ?? 0) + 1);
    this.tell();
    return () => {
      for (const name of names) {
        const left = (this.wanted.get(name) ?? 1) - 1;
        if (left > 0) this.wanted.set(name, left);
        else {
          this.wanted.delete(name);
          this.series.delete(name);
          this.silences.delete(name);
        }
      }
      this.tell();
    };
  }

  history(name: string, from: number, to: number, pixels: number): Promise<Points> {
    const id = this.nextId++;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket?.send(JSON.stringify({ history: name, id, from, to, pixels }));
    });
  }

  points = (name: string): Points | undefined => this.series.get(name);
  /** When the service says that there was no value; one that lasts ends now. */
  gaps = (name: string): [number, number][] => (this.silences.get(name) ?? []).map(([from, to]) => [from, to ?? Math.max(from, this.now)]);
  listen = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
}

export const live = new Live();

/** Watch series; the number goes up whenever one of them has new points. */
export function useLive(names: string[], seconds: number): number {
  const key = names.join("\n");
  useEffect(() => live.watch(key ? key.split("\n") : [], seconds), [key, seconds]);
  return useSyncExternalStore(live.listen, () => live.version);
}
