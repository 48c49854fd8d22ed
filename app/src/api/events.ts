// What the server tells while a page is open: one stream for the whole window.
import { signal } from "@preact/signals";

const KINDS = ["record", "observation", "state", "finding", "asset", "job"] as const;
const REST_MS = 800;
/** A farm tells something every moment; a list of all turbines is asked for again after this time. */
const REST_ALL_MS = 3000;

export const connection = signal<"connecting" | "live" | "lost">("connecting");
/** Counts what happened, by asset; "" counts everything. */
export const happened = signal<Record<string, number>>({ "": 0 });

let [pending, told] = [new Set<string>(), 0];
let timer: ReturnType<typeof setTimeout> | undefined;

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

/** Hear what a server tells until the function that comes back is called. A browser returns by itself, unless it was refused. */
export function hear(
  url: string,
  kinds: readonly string[],
  on: (said: unknown) => void,
  there: (now: boolean) => void = () => undefined,
): () => void {
  let [source, timer]: [EventSource | null, number] = [null, 0];
  const begin = (): void => {
    const one = (source = new EventSource(url));
    one.onopen = () => there(true);
    one.onerror = () => {
      there(false);
      if (one.readyState === EventSource.CLOSED) timer = setTimeout(begin, 5000);
    };
    for (const kind of kinds) one.addEventListener(kind, (e: MessageEvent<string>) => on(JSON.parse(e.data)));
  };
  begin();
  return () => {
    clearTimeout(timer);
    source?.close();
  };
}

let stop: (() => void) | null = null;

export function listen(): void {
  stop ??= hear(
    "/api/v1/events",
    KINDS,
    (said) => note([String((said as { asset?: string }).asset ?? "")]),
    (now) => {
      if (now && connection.value === "lost") note([]);
      connection.value = now ? "live" : "lost";
    },
  );
}

export function stopListening(): void {
  stop?.();
  stop = null;
  connection.value = "connecting";
}
