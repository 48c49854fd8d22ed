// What the server tells while a page is open: one stream for the whole window.
import { signal } from "@preact/signals";

const KINDS = ["record", "observation", "state", "finding", "asset", "job"] as const;
const REST_MS = 800;
/** A farm tells something every moment; a list of all turbines is asked for again after this time. */
const REST_ALL_MS = 3000;

export type Connection = "connecting" | "live" | "lost";
export const connection = signal<Connection>("connecting");
/** Counts what happened, by asset; "" counts everything. */
export const happened = signal<Record<string, number>>({ "": 0 });

let source: EventSource | null = null;
let pending = new Set<string>();
let timer: ReturnType<typeof setTimeout> | undefined;

let told = 0;

function note(assets: Iterable<string>): void {
  for (const asset of [...assets, ""]) pending.add(asset);
  timer ??= setTimeout(() => {
    timer = undefined;
    const all = Date.now() - told >= REST_ALL_MS;
    const counts = { ...happened.value };
    for (const asset of pending) if (asset || all) counts[asset] = (counts[asset] ?? 0) + 1;
    pending = new Set();
    if (all) told = Date.now();
    else note([]);
    happened.value = counts;
  }, REST_MS);
}

/** Begin to listen; a browser comes back by itself, with the number of the last event it knows. */
export function listen(): void {
  if (source) return;
  source = new EventSource("/api/v1/events");
  source.onopen = () => {
    if (connection.value === "lost") note([]);
    connection.value = "live";
  };
  source.onerror = () => {
    connection.value = "lost";
    if (source?.readyState === EventSource.CLOSED) {
      source = null;
      setTimeout(listen, 5000);
    }
  };
  for (const kind of KINDS)
    source.addEventListener(kind, (event: MessageEvent<string>) => {
      const said: unknown = JSON.parse(event.data);
      if (typeof said === "object" && said !== null && "asset" in said) note([String(said.asset)]);
    });
}

export function stopListening(): void {
  source?.close();
  source = null;
  connection.value = "connecting";
}
