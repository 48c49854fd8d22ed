// Where the reader is: path and query, so that a link holds all that a page shows.
import { computed, signal } from "@preact/signals";

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

/** Keep something of what a page shows in its address; null forgets it. */
export function keep(values: Record<string, string | null>): void {
  const query = new URLSearchParams(place.value.query);
  for (const [name, value] of Object.entries(values)) {
    if (value === null) query.delete(name);
    else query.set(name, value);
  }
  place.value = { path: place.value.path, query };
  clearTimeout(waits);
  const rest = written + PACE_MS - performance.now();
  if (rest > 0) waits = setTimeout(write, rest);
  else write();
}

export const asked = (name: string): string | null => place.value.query.get(name);

/** A number that stands in the address unless it is the usual one, and how to change it. */
export const kept = (name: string, usual: number): [number, (to: number) => void] => [
  Number(asked(name) ?? usual) || (asked(name) === "0" ? 0 : usual),
  (to) => keep({ [name]: to === usual ? null : String(Number(to.toFixed(3))) }),
];

/** Follow links of ours without leaving the page. */
document.addEventListener("click", (event) => {
  if (event.defaultPrevented || event.button !== 0 || event.metaKey || event.ctrlKey || event.shiftKey) return;
  const link = (event.target as Element).closest("a");
  if (!link || link.target || link.hasAttribute("download") || link.origin !== location.origin) return;
  if (link.dataset["leave"] !== undefined || link.hash) return;
  event.preventDefault();
  go(link.pathname + link.search);
});

export type Route = { page: string; asset: string; id: string };

/** /assets/wtg/records/1a2b is the page "record" of "wtg"; pages of no turbine have no asset. */
export function routeOf(path: string): Route {
  const [first = "", asset = "", page = "", id = ""] = path.split("/").slice(1).map(decodeURIComponent);
  if (first !== "assets" || !asset) return { page: first || "fleet", asset: "", id: "" };
  return { page: id ? "record" : page || "turbine", asset, id };
}

export const route = computed(() => routeOf(place.value.path));
export const assetUrl = (asset: string, page = "", id = ""): string =>
  ["/assets", asset, page, id]
    .filter(Boolean)
    .map((part, i) => (i ? encodeURIComponent(part) : part))
    .join("/");
