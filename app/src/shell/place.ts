// Where the reader is: path and query, so that a link holds all that a page shows.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";

/** What the address tells a page. */
export type PageProps = { asset: string; id: string };

const here = () => ({ path: location.pathname, query: new URLSearchParams(location.search) });
export const place = signal(here());

window.addEventListener("popstate", () => (place.value = here()));

const PACE_MS = 150; // browsers write two hundred addresses in half a minute, and not one more
let [written, waits] = [0, 0];

function write(): void {
  clearTimeout(waits);
  [written, waits] = [performance.now(), 0];
  const text = place.value.query.toString();
  history.replaceState(null, "", place.value.path + (text && `?${text}`));
}

export function go(url: string, replace = false): void {
  if (waits) write();
  history[replace ? "replaceState" : "pushState"](null, "", url);
  const before = place.value.path;
  place.value = here();
  if (before !== place.value.path) {
    window.scrollTo(0, 0);
    document.getElementById("main")?.focus({ preventScroll: true });
  }
}

type Values = Record<string, string | null>;

/** What the address holds, with some values changed; null forgets one. */
function queryWith(values: Values): URLSearchParams {
  const query = new URLSearchParams(place.value.query);
  for (const [name, value] of Object.entries(values)) {
    if (value === null) query.delete(name);
    else query.set(name, value);
  }
  return query;
}

/** This page with something of what it shows changed, to follow. */
export const linkWith = (values: Values): string => `?${queryWith(values).toString()}`;

/** Keep something of what a page shows in its address. */
export function keep(values: Values): void {
  place.value = { path: place.value.path, query: queryWith(values) };
  clearTimeout(waits);
  const rest = written + PACE_MS - performance.now();
  if (rest > 0) waits = setTimeout(write, rest);
  else write();
}

export const asked = (name: string): string | null => place.value.query.get(name);

/** What the address asks for and the page does not have, by name: the frame says so. */
export const strange = signal<Readonly<Record<string, string>>>({});

/** Say of what the address asks for under some names that there is no such thing, while that is so. */
export function useStrange(names: readonly string[]): void {
  const odd = Object.fromEntries(names.map((name) => [name, asked(name) ?? ""]));
  useEffect(() => {
    if (!names.length) return;
    strange.value = { ...strange.value, ...odd };
    const others = (): [string, string][] => Object.entries(strange.value).filter(([name]) => !(name in odd));
    return () => (strange.value = Object.fromEntries(others()));
  }, [JSON.stringify(odd)]);
}

/** What may be chosen, by its name in the address, where that is not what is read. */
export type Options = readonly (string | readonly [string, string])[];
const keysOf = (options: Options): string[] => options.map((one) => (typeof one === "string" ? one : one[0]));

/** Which of some things the address chooses; the usual one if it says nothing, or what is not among them. */
export function chosen(name: string, options: Options = [], usual = keysOf(options)[0] ?? ""): string {
  const value = asked(name);
  return value !== null && keysOf(options).includes(value) ? value : usual;
}

/** The same, and what is not among them is said; nothing is judged before the options are known. */
export function useChosen(name: string, options: Options | undefined, usual?: string): string {
  const value = asked(name);
  useStrange(options === undefined || value === null || keysOf(options).includes(value) ? [] : [name]);
  return chosen(name, options, usual);
}

/** A number that stands in the address unless it is the usual one, if it lies within its limits. */
export function numberAsked(name: string, low: number, high: number): number | null {
  const value = Number(asked(name) || NaN);
  return value >= low && value <= high ? value : null;
}

/** The stretch of time that the address holds [s]; null for all, or if it is none. */
export const stretch = computed((): [number, number] | null => {
  const [from, to] = [Date.parse(asked("from") ?? "") / 1000, Date.parse(asked("to") ?? "") / 1000];
  return from < to ? [from, to] : null;
});

export function keepStretch(range: readonly [number, number] | null): void {
  const [from = null, to = null] = range?.map((s) => new Date(s * 1000).toISOString().replace(".000", "")) ?? [];
  keep({ from, to });
}

/** Follow links of ours without leaving the page. */
document.addEventListener("click", (event) => {
  if (event.defaultPrevented || event.button !== 0 || event.metaKey || event.ctrlKey || event.shiftKey) return;
  const link = (event.target as Element).closest("a");
  if (!link || link.target || link.hasAttribute("download") || link.origin !== location.origin) return;
  if (link.dataset["leave"] !== undefined || link.hash) return;
  event.preventDefault();
  go(link.pathname + link.search);
});

/** A part of a path, of whatever bytes: what is no UTF-8 names nothing. */
const decoded = (part: string): string =>
  new URLSearchParams(`_=${part.replaceAll("+", "%2B").replaceAll("&", "%26")}`).get("_") ?? "";

/** /assets/wtg/records/1a2b is the page "record" of "wtg"; pages of no turbine have no asset. */
export function routeOf(path: string) {
  const [first = "", asset = "", page = "", id = ""] = path.split("/").slice(1).map(decoded);
  if (first !== "assets" || !asset) return { page: first || "fleet", asset: "", id: "" };
  return { page: id ? "record" : page || "turbine", asset, id };
}

export const route = computed(() => routeOf(place.value.path));
export const assetUrl = (asset: string, page = "", id = ""): string =>
  ["/assets", asset, page, id]
    .filter(Boolean)
    .map((part, i) => (i ? encodeURIComponent(part) : part))
    .join("/");
