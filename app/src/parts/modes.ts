// How modes look: the colour by kind, as in the report, and their plots through time.
import type { Alarm, Mode, Schemas } from "../api/client";
import { NORMAL_90, words } from "../words/numbers";
import { day, seconds } from "../words/time";
import type { Mark, PlotData } from "./plot/series";

export const PAINTS = ["blue", "vermillion", "green", "purple", "orange", "sky", "grey", "ink"];
/** The colour of the k-th of some series. */
export const paintOf = (k: number): string => PAINTS[k % PAINTS.length] ?? "blue";
export type Bins = Schemas["ModeBinsOut"];

const KINDS: Record<string, string> = {
  fore_aft: "blue",
  side_side: "vermillion",
  torsion: "green",
  heave: "purple",
};

const DASHES: Record<string, number[]> = { 2: [7, 4], 3: [2, 3], 4: [9, 3, 2, 3], 5: [9, 3, 2, 3, 2, 3] };
/** The line of a mode by its number, as its colour is by its kind. */
export const modeDash = (label: string): { dash?: number[] } => {
  const dash = DASHES[/\d+$/.exec(label)?.[0] ?? ""];
  return dash ? { dash } : {};
};

export function modeColour(label: string): string {
  const [, kind = "", number = "0"] = /^(.*)_(\d+)$/.exec(label) ?? [];
  return KINDS[kind] ?? paintOf(Number(number) % 6);
}

/** Modes through time by label. */
export function byLabel(modes: readonly Mode[]): Map<string, Mode[]> {
  const found = new Map<string, Mode[]>();
  for (const mode of modes) {
    const rows = found.get(mode.label);
    if (rows) rows.push(mode);
    else if (mode.label) found.set(mode.label, [mode]);
  }
  for (const rows of found.values()) rows.sort((a, b) => a.time_utc.localeCompare(b.time_utc));
  return found;
}

/** From the day that a change began to that on which it was found. */
export const alarmMarks = (alarms: readonly Alarm[] = []): Mark[] =>
  alarms.map(({ time_utc: found, params: { began } }) => {
    const mark = { x: seconds(found), words: `alarm ${day(found)}`, colour: "alarm" };
    if (typeof began !== "string") return mark;
    return { ...mark, x: seconds(`${began}T00:00:00Z`), to: mark.x, words: `began ${began}, alarm ${day(found)}` };
  });

export function modePlot(label: string, modes: readonly Mode[], what: string, marks: Mark[]): PlotData {
  const damping = what === "damping";
  const value = (m: Mode): number | null => (damping ? m.damping_ratio && 100 * m.damping_ratio : m.frequency_hz);
  const end = (m: Mode, i: 0 | 1): number | null => {
    const known = m.damping_ratio_interval_90?.[i];
    if (damping) return known === undefined ? null : 100 * known;
    return m.frequency_std_hz === null ? null : m.frequency_hz + (i ? NORMAL_90 : -NORMAL_90) * m.frequency_std_hz;
  };
  return {
    title: words(label),
    yName: damping ? "damping ratio [%], 90 % intervals" : "frequency [Hz], 90 % intervals",
    log: damping,
    series: [
      {
        name: words(label),
        colour: modeColour(label),
        kind: "points",
        x: modes.map((m) => seconds(m.time_utc)),
        y: modes.map(value),
        low: modes.map((m) => end(m, 0)),
        high: modes.map((m) => end(m, 1)),
      },
    ],
    marks,
  };
}

/** Of more rows than can be drawn: the extremes and the median of each bin of time. */
export function binPlot(bins: Bins, what: string, marks: Mark[]): PlotData {
  const damping = what === "damping";
  const { min, median, max } = damping ? bins.damping_ratio : bins.frequency_hz;
  const shown = (values: (number | null)[]): (number | null)[] =>
    damping ? values.map((v) => v && 100 * v) : values;
  const start = seconds(bins.start_utc);
  const x = bins.time_s.map((t) => start + t + bins.bin_s / 2);
  const same = { colour: modeColour(bins.label), x };
  return {
    title: words(bins.label),
    yName: damping ? "damping ratio [%]" : "frequency [Hz]",
    log: damping,
    series: [
      { ...same, name: "least to greatest", kind: "band", y: [], low: shown(min), high: shown(max) },
      { ...same, name: "median", kind: "points", y: shown(median) },
    ],
    marks,
  };
}
