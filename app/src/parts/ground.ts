// The ground's stiffness of each day over that of the first: known then, known by now, and what to expect.
import type { Schemas } from "../api/client";
import { day, seconds } from "../words/time";
import type { PlotData, Series } from "./plot/series";

export type Supports = Schemas["SupportsOut"];
type Median = Schemas["MedianOut"];

const DAY_S = 86_400;
const spans = (points: [number, Median][]): Pick<Series, "x" | "y" | "low" | "high"> => ({
  x: points.map(([x]) => x),
  y: points.map(([, v]) => v.median),
  low: points.map(([, v]) => v.interval_90[0] ?? null),
  high: points.map(([, v]) => v.interval_90[1] ?? null),
});

const ordered = (found: Supports): [string, Median][] =>
  Object.entries(found.stiffness_in_time?.smoothed ?? {}).sort(([a], [b]) => a.localeCompare(b));
const noon = (date: string): number => seconds(`${date}T12:00:00Z`);
const smoothed = (days: [string, Median][]) => spans(days.map(([date, v]) => [noon(date), v]));
export const OTHERS = ["orange", "purple", "green"]; // as many other versions as a plot can bear, the newest

/** The version asked for, and beside it what others know by now. */
export function stiffnessPlot(found: Supports, others: Supports[]): PlotData {
  const then = (found.days ?? [])
    .flatMap((d) => (d.relative_stiffness ? [{ x: seconds(d.time_utc), v: d.relative_stiffness }] : []))
    .reverse();
  const time = found.stiffness_in_time;
  const days = ordered(found);
  const now = smoothed(days);
  const last = seconds((found.days ?? [])[0]?.time_utc ?? "1970-01-01T00:00:00Z");
  const later = spans((time?.forecast ?? []).map((f) => [last + f.days * DAY_S, f]));
  return {
    title: "Ground stiffness through time",
    yName: "over that of the first day",
    series: [
      { name: "90 % by now", colour: "blue", kind: "band", ...now },
      { name: `known by now, version ${found.version}`, colour: "blue", kind: "line", x: now.x, y: now.y },
      ...OTHERS.slice(0, others.length).map((colour, i) => {
        const other = others[i] as Supports;
        const { x, y } = smoothed(ordered(other));
        return { name: `version ${other.version}`, colour, kind: "line", dash: [2, 3], x, y };
      }),
      { name: "90 % to expect", colour: "grey", kind: "band", ...later },
      { name: "to expect", colour: "grey", kind: "line", dash: [6, 4], x: later.x, y: later.y },
      {
        name: "known on the day",
        colour: "ink",
        kind: "points",
        x: then.map((d) => d.x),
        y: then.map((d) => d.v.median),
      },
    ].filter((s) => s.x.length) as Series[],
    marks: (time?.changes ?? []).map((c) => {
      const by = day(c.time_utc);
      const after = days.findLast(([date]) => date < by)?.[0] ?? by; // the last day known to be as before
      return { x: noon(after), to: noon(by), words: `change, ${after} to ${by}`, colour: "alarm" };
    }),
  };
}
