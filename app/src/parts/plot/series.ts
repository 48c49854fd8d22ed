// What a plot is given, and the same as CSV and SVG.
import { short } from "../../words/numbers";
import { day, utc } from "../../words/time";

export interface Series {
  name: string;
  /** Name of one of our colours. */
  colour: string;
  kind: "points" | "line" | "band";
  x: ArrayLike<number>;
  y: ArrayLike<number | null>;
  low?: ArrayLike<number | null>;
  high?: ArrayLike<number | null>;
  /** Lengths of strokes and gaps [px]. */
  dash?: number[];
  /** A name for each point, written beside it, and what is said of it where it is pointed at. */
  names?: readonly string[];
  said?: readonly string[];
  /** A band that is itself what is measured: extremes of a signal. */
  solid?: boolean;
}

/** A moment, or a stretch, that something is said of. */
export type Mark = { x: number; to?: number; words: string; colour: string };

/** Where the words of marks stand: right of their own, left of it where there is no room, in the first free line. */
export function wordsOf(
  marks: readonly Mark[] = [],
  px: (x: number) => number,
  wide: (words: string) => number,
  [left, right]: Range,
): (Mark & { at: number; line: number })[] {
  const [free, inOrder] = [[-Infinity, -Infinity, -Infinity], marks.toSorted((a, b) => a.x - b.x)]; // where each line ends
  return inOrder.flatMap((mark) => {
    const [x, width] = [px(mark.x), wide(mark.words)];
    const at = Math.max(x + width > right ? x - width : x, left);
    const line = free.findIndex((end) => at > end);
    if (x < left || x > right || line < 0) return [];
    free[line] = at + width;
    return [{ ...mark, at, line }];
  });
}

export interface PlotData {
  title: string;
  /** Where it has no name, x is time: seconds since 1970. */
  xName?: string;
  yName: string;
  log?: boolean;
  /** Whether the x axis counts decades; never with time. */
  logX?: boolean;
  series: Series[];
  marks?: Mark[];
}

export type Range = [number, number];

export const stamp = (seconds: number): string => new Date(seconds * 1000).toISOString();
type Cell = string | number | null | undefined;
const quoted = (text: string): string => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** Rows as CSV, the first of which names the columns. */
export const csvFrom = (rows: readonly (readonly Cell[])[]): string =>
  rows.map((row) => row.map((cell) => quoted(String(cell ?? ""))).join(",") + "\n").join("");

/** One line a point: series, x, y, low, high. */
export const csvOf = ({ series, xName, yName }: PlotData): string =>
  csvFrom([
    ["series", xName ?? "time_utc", yName, "low", "high"],
    ...series.flatMap((s) =>
      Array.from(s.x, (x, i): Cell[] => [s.name, xName ? x : stamp(x), s.y[i], s.low?.[i], s.high?.[i]]),
    ),
  ]);

const FEW = 30;
/** Of more points, the widest intervals are cut off: a few short records would hide what all others show. */
const ROOM = 0.25;

/** Of more points, those whose intervals are so many times wider than most do not set the scale. */
const VAGUE = 4;
const usual = new WeakMap<Series, number>();

/** Width of an interval that most of many points have. */
function usualWidth(s: Series): number {
  const found = usual.get(s);
  if (found !== undefined) return found;
  const all = Array.from(s.x, (_, i) => (s.high?.[i] ?? NaN) - (s.low?.[i] ?? NaN)).filter((w) => w >= 0);
  const width = s.x.length > FEW ? (all.sort((a, b) => a - b)[all.length >> 1] ?? Infinity) : Infinity;
  usual.set(s, width);
  return width;
}

/** The extremes of what is shown between two places of x; of positive numbers only if logarithmic. */
export function spanOf(plot: PlotData, range: Range | null, vague = VAGUE): Range {
  let [low, high] = [Infinity, -Infinity];
  const see = (value: number | null | undefined): void => {
    if (value === null || value === undefined || (plot.log && value <= 0)) return;
    if (value < low) low = value;
    if (value > high) high = value;
  };
  for (const s of plot.series)
    for (let i = 0; i < s.x.length; i++) {
      const x = s.x[i] ?? NaN;
      if (range && (x < range[0] || x > range[1])) continue;
      if (s.kind === "points" && (s.high?.[i] ?? 0) - (s.low?.[i] ?? 0) > vague * usualWidth(s)) continue;
      see(s.y[i]);
      if (s.kind === "points" && s.x.length > FEW) continue;
      see(s.low?.[i]);
      see(s.high?.[i]);
    }
  if (low > high && vague < Infinity) return spanOf(plot, range, Infinity);
  if (low > high) return plot.log ? [0.1, 1] : [0, 1];
  if (plot.log) return [low / 1.3, high * 1.3];
  const cut = plot.series.some((s) => s.kind === "points" && s.x.length > FEW && s.low);
  const room = (high - low || Math.abs(high) || 1) * (cut ? ROOM : 0.08);
  return [low - room, high + room];
}

export function extentOf(plot: PlotData): Range {
  let [first, last] = [Infinity, -Infinity];
  for (const s of plot.series) {
    const ends = !plot.xName ? [s.x[0], s.x[s.x.length - 1]] : Array.from(s.x); // times are in order
    for (const x of ends) if (x !== undefined) [first, last] = [Math.min(first, x), Math.max(last, x)];
  }
  if (first > last) return plot.logX ? [0.1, 1] : [0, 1];
  if (plot.logX) return [first, last];
  const room = (last - first || (plot.xName ? 1 : 86_400)) * 0.02;
  return [first - room, last + room];
}

export const readX = (plot: PlotData, x: number, span: number): string =>
  plot.xName ? short(x, 5) : span > 40 * 86_400 ? day(stamp(x)) : `${utc(stamp(x))} UTC`;

/** Places of an axis that people count in. */
export function ticksOf([low, high]: Range, most: number, log = false): number[] {
  if (!(high > low) || !Number.isFinite(high - low) || (log && low <= 0)) return []; // as before there are data
  if (log) {
    const decades = Math.log10(high / low);
    const every = Math.max(Math.min(Math.ceil(decades / most), Math.floor((decades + 1) / 2)), 1);
    const found = [];
    for (let p = Math.ceil(Math.log10(low) - Number(every < 2)); p <= Math.log10(high); p += every)
      for (const m of decades < most / 2 ? [1, 2, 5] : [1]) {
        const value = Number(`${m}e${p}`);
        if (value >= low && value <= high) found.push(value);
      }
    if (found.length > 2 || decades > 2) return found;
  }
  const raw = (high - low) / most;
  const size = 10 ** Math.floor(Math.log10(raw));
  const count = (step: number): number => Math.floor(high / step + 1e-9) - Math.ceil(low / step) + 1;
  const sizes = [0.5, 1, 2, 5, 10].map((m) => m * size);
  const k = sizes.findIndex((one) => one >= raw);
  const step = sizes[count(sizes[k] ?? size) < 2 ? k - 1 : k] ?? size; // one tick alone tells nothing of the scale
  const first = Math.ceil(low / step);
  const many = count(step); // counted, not added up to: a step may be lost in what it is added to
  return Array.from({ length: many }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

const MINUTE_S = 60;
const STEPS_S = [1, 5, 10, 30, 60, 180, 360, 720, 1440, 7 * 1440].map((minutes) => minutes * MINUTE_S);
const MONTHS = [1, 2, 3, 6, 12, 24, 60];

/** Places of a time axis: whole hours, days, or months. */
export function timeTicksOf(range: Range, most: number): number[] {
  const least = (range[1] - range[0]) / most;
  const step = least < MINUTE_S / 2 ? 0 : STEPS_S.find((one) => one >= least);
  if (step === 0) return ticksOf(range, most);
  const months = MONTHS.find((n) => n * 30 * 1440 * MINUTE_S >= least) ?? 120;
  const month = (k: number): number => Date.UTC(1970, k * months, 1) / 1000;
  const place = (k: number): number => (step ? k * step : month(k));
  let k = Math.floor(range[0] / (step ?? 31 * 1440 * MINUTE_S * months));
  const found = [];
  for (; place(k) <= range[1]; k++) if (place(k) >= range[0]) found.push(place(k));
  return found;
}
