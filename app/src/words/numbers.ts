// Numbers as people read them, as report/tables/numbers.py writes them: tests/numbers.json holds both to it.

export const UNKNOWN = "–";
const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const WIDE = 0.2;
const PREFIXES: readonly (readonly [number, string])[] = [
  [1e12, "T"],
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
];

type Number_ = number | null | undefined;

const known = (value: Number_): value is number => typeof value === "number" && Number.isFinite(value);
/** With the true minus sign, which is as wide as a digit. */
export const minus = (text: string): string => text.replaceAll("-", "−");
/** Round half to even where a decimal tie is exact, as Python does. */
export function fixed(value: Number_, decimals: number): string {
  if (!known(value)) return UNKNOWN;
  const digits = { minimumFractionDigits: decimals, maximumFractionDigits: decimals };
  const how = { ...digits, useGrouping: false, roundingMode: "halfEven", signDisplay: "negative" } as const;
  return minus(value.toLocaleString("en", how));
}

/** Every interval holds 90 %: of a normal scatter so many standard deviations to each side, and so says ±. */
export const NORMAL_90 = 1.6448536269514722;
function withStd(value: Number_, std: Number_, scale: number, decimals: number): string {
  if (!known(value)) return UNKNOWN;
  if (!known(std)) return fixed(scale * value, decimals);
  const half = NORMAL_90 * scale * std;
  // a small one has one digit at least
  const digits = half > 0 ? Math.max(decimals, Math.min(Math.ceil(-Math.log10(half)), 9)) : decimals;
  return `${fixed(scale * value, digits)} ± ${fixed(half, digits)}`;
}

/** Hertz with four decimals. */
export const frequency = (value: Number_, std?: Number_): string => withStd(value, std, 1, 4);
/** A ratio in per cent, without the sign. */
export const percent = (value: Number_, std?: Number_, decimals = 2): string => withStd(value, std, 100, decimals);

export function scientific(value: Number_, digits = 3): string {
  if (!known(value)) return UNKNOWN;
  const [mantissa = "0", exponent = "0"] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power >= -3 && power <= digits)
    return minus(Number(value.toPrecision(digits)).toFixed(Math.max(digits - 1 - power, 0)));
  const above = [...String(power)].map((c) => (c === "-" ? "⁻" : (SUPERSCRIPT[Number(c)] ?? c))).join("");
  return `${minus(mantissa)} × 10${above}`;
}

/** Significant digits without an exponent or trailing zeros. */
export const short = (value: number, digits: number): string => minus(String(Number(value.toPrecision(digits))));

/** A number beside an axis. */
export const onAxis = (v: number): string =>
  v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6)
    ? scientific(v, 3)
        .replace(/\.?0+ ×/, " ×")
        .replace(/^1 × /, "")
    : short(v, 6);

/** m/s^2: m/s². */
export const raised = (unit: string): string => unit.replaceAll("^2", "²");

/** A number of any size with its unit and the prefix that suits. */
export function quantity(value: Number_, unit: string, digits = 2): string {
  if (!known(value)) return UNKNOWN;
  if (unit === "" || unit === "-") return short(value, digits);
  const near = Number(value.toPrecision(digits));
  const [scale, prefix] = PREFIXES.find(([size]) => Math.abs(near) >= size) ?? [1, ""];
  return `${short(near / scale, digits)} ${prefix}${unit}`;
}

/** How many significant digits tell the ends of an interval of positive numbers apart. */
export function digitsOf(low: number, high: number): number {
  const width = low > 0 ? high / low - 1 : 1;
  return width > WIDE ? 2 : width > WIDE / 10 ? 3 : 4;
}

/** "2 to 14 GN/m", the unit once where both have the same prefix. */
export function between(low: number, high: number, unit: string): string {
  const digits = digitsOf(low, high);
  const [a, b] = [quantity(low, unit, digits), quantity(high, unit, digits)];
  const [number = "", same] = a.split(" ");
  return same !== undefined && same === b.split(" ")[1] ? `${number} to ${b}` : `${a} to ${b}`;
}

/** side_side_1: side-side 1. */
export const words = (label: string): string => label.replace(/_(\d+)$/, " $1").replaceAll("_", "-");
export const count = (n: number, noun: string): string => `${n} ${noun}${n === 1 ? "" : "s"}`;
/** What an estimate is of: 730 records up to 2025-12-01. */
export const recordsOf = (of?: { records: number; until_utc?: string | null }): string =>
  count(of?.records ?? 0, "record") + (of?.until_utc ? ` up to ${of.until_utc.slice(0, 10)}` : "");

const LONG_YEARS = 1000;
/** Years without digits that nobody knows. */
export const years = (value: number | null): string =>
  value === null || !Number.isFinite(value) || value > LONG_YEARS
    ? "> 1000"
    : String(Number(value.toPrecision(value < 10 ? 1 : 2)));
type Ends = readonly (number | null)[] | null;
/** "0.3 to 22", and with the median before. */
export const yearsTo = (ends: Ends): string => `${years(ends?.[0] ?? null)} to ${years(ends?.[1] ?? null)}`;
export const yearsWithin = (value: number | null, ends: Ends): string =>
  years(value) + (years(ends?.[0] ?? null) === years(ends?.[1] ?? null) ? "" : ` (${yearsTo(ends)})`);
/** A sentence of the server with modes and numbers as the pages write them. */
export const sentence = (text: string): string =>
  text
    .replace(/\b(fore_aft|side_side|torsion|heave|foot)_\d+\b/g, words)
    .replace(/(\d) ?%/g, "$1\u00a0%")
    .replace(/([ (])-(?=\d)/g, "$1−")
    .replace(/^[a-z]/, (first) => first.toUpperCase());
