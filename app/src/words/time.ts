// Times: always UTC on the page, the reader's own clock on hover.

/** 2025-03-01 12:00 */
export const utc = (time: string): string => time.slice(0, 16).replace("T", " ");
export const day = (time: string): string => time.slice(0, 10);

/** What a reader's own clock said then, with its zone. */
export function local(time: string): string {
  const said = new Date(time).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "long" });
  return `${said} by this clock`;
}

/** 14:00, by the reader's own clock. */
export const here = (seconds: number): string => new Date(seconds * 1000).toTimeString().slice(0, 5);

const STEPS: readonly (readonly [number, string])[] = [
  [86_400, "day"],
  [3600, "hour"],
  [60, "minute"],
];

/** "2 hours ago" */
export function ago(time: string, now: number): string {
  const seconds = (now - Date.parse(time)) / 1000;
  const [size, name] = STEPS.find(([least]) => Math.abs(seconds) >= least) ?? [1, ""];
  if (!name) return "just now";
  const n = Math.floor(Math.abs(seconds) / size);
  return `${seconds < 0 ? "in " : ""}${n} ${name}${n === 1 ? "" : "s"}${seconds < 0 ? "" : " ago"}`;
}

export const seconds = (time: string): number => Date.parse(time) / 1000;
