// A plot as a drawing of its own, for documents: the same series, marks and range as on the page.
import type { PlotData, Range, Series } from "./series";
import { onAxis, raised } from "../../words/numbers";
import { readX, spanOf, ticksOf, timeTicksOf, wordsOf } from "./series";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [900, 360, 70, 16, 40, 46];
const escaped = (text: string): string =>
  text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c] ?? c);

/** About how wide a letter is [px]. */
const LETTER = 6.6;

export function svgOf(plot: PlotData, range: Range, paint: (name: string) => string): string {
  const span = spanOf(plot, range);
  const scale = plot.log ? Math.log10 : (v: number) => v;
  const [y0, y1] = [scale(span[0]), scale(span[1])];
  const along = plot.logX ? Math.log10 : (v: number) => v;
  const [x0, x1] = [along(range[0]), along(range[1])];
  const parts: string[] = [];
  const at = (v: number): string => v.toFixed(1);
  const text = (x: number, y: number, words: string, anchor = "start"): number =>
    parts.push(`<text x="${at(x)}" y="${at(y)}" text-anchor="${anchor}">${escaped(words)}</text>`);
  let [left, top] = [LEFT, TOP];
  for (const s of plot.series.length > 1 ? plot.series : []) {
    const wide = 44 + LETTER * s.name.length;
    if (top === TOP || left + wide > WIDTH) [left, top] = [LEFT, top + 18];
    const look = `stroke="${paint(s.colour)}" stroke-width="${s.kind === "band" ? 8 : 2}" stroke-opacity="${s.kind === "band" ? 0.3 : 1}"`;
    const dash = s.kind === "points" ? [3, 2] : (s.dash ?? []);
    parts.push(`<path d="M${at(left)} ${top - 10}h24" ${look} stroke-dasharray="${dash.join(" ") || "none"}"/>`);
    text(left + 30, top - 6, s.name);
    left += wide;
  }
  const px = (x: number): number => LEFT + ((along(x) - x0) / (x1 - x0)) * (WIDTH - LEFT - RIGHT);
  const py = (y: number): number => {
    const up = ((scale(y) - y0) / (y1 - y0)) * (HEIGHT - top - BOTTOM);
    return Math.min(Math.max(HEIGHT - BOTTOM - up, top), HEIGHT - BOTTOM); // what is beyond the scale: at its edge
  };
  for (const v of ticksOf(span, 5, plot.log)) {
    parts.push(`<path d="M${LEFT} ${at(py(v))}H${WIDTH - RIGHT}" stroke="${paint("line")}"/>`);
    text(LEFT - 6, py(v) + 4, onAxis(v), "end");
  }
  for (const v of plot.xName ? ticksOf(range, 6, plot.logX) : timeTicksOf(range, 6))
    text(px(v), HEIGHT - BOTTOM + 18, plot.xName ? onAxis(v) : readX(plot, v, range[1] - range[0]), "middle");
  text(LEFT, 18, plot.title);
  text(LEFT, 34, raised(plot.yName));
  text(WIDTH - RIGHT, HEIGHT - 6, plot.xName ?? "UTC", "end");
  for (const s of plot.series) parts.push(...shapes(s, range, plot.log ?? false, px, py, paint(s.colour)));
  const down = HEIGHT - BOTTOM - top;
  for (const { x, to, colour } of plot.marks ?? []) {
    if (x < range[0] || x > range[1]) continue;
    parts.push(`<path d="M${at(px(x))} ${top}v${down}" stroke="${paint(colour)}" stroke-dasharray="4 3"/>`);
    if (to !== undefined)
      parts.push(`<path d="M${at(px(x))} ${top}H${at(px(to))}v${down}H${at(px(x))}Z" fill="${paint(colour)}" fill-opacity="0.13"/>`); // prettier-ignore
  }
  for (const one of wordsOf(plot.marks, px, (words) => 8 + LETTER * words.length, [LEFT, WIDTH - RIGHT]))
    text(one.at + 4, top + 12 + 14 * one.line, one.words);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${HEIGHT}" font-family="sans-serif" font-size="12" fill="${paint("ink")}"><rect width="${WIDTH}" height="${HEIGHT}" fill="${paint("paper")}"/>${parts.join("")}</svg>`;
}

type Scale = (v: number) => number;

function shapes(s: Series, range: Range, log: boolean, px: Scale, py: Scale, paint: string): string[] {
  const seen = Array.from(s.x, (x, i) => ({ x, y: s.y[i], low: s.low?.[i], high: s.high?.[i] })).filter(
    (p) => p.x >= range[0] && p.x <= range[1],
  );
  const there = (v: number | null | undefined): v is number => typeof v === "number" && (!log || v > 0);
  const path = (points: [number, number][]): string =>
    points.map(([x, y], i) => `${i ? "L" : "M"}${px(x).toFixed(1)} ${py(y).toFixed(1)}`).join("");
  if (s.kind === "band") {
    const up = seen.flatMap((p): [number, number][] => (there(p.high) ? [[p.x, p.high]] : []));
    const down = seen.flatMap((p): [number, number][] => (there(p.low) ? [[p.x, p.low]] : [])).reverse();
    return [`<path d="${path([...up, ...down])}Z" fill="${paint}" fill-opacity="0.18"/>`];
  }
  const points = seen.flatMap((p): [number, number][] => (there(p.y) ? [[p.x, p.y]] : []));
  if (s.kind === "line") {
    const dash = s.dash ? ` stroke-dasharray="${s.dash.join(" ")}"` : "";
    return [`<path d="${path(points)}" fill="none" stroke="${paint}" stroke-width="1.5"${dash}/>`];
  }
  const bars = seen.flatMap((p) =>
    there(p.low) && there(p.high) ? [`M${px(p.x).toFixed(1)} ${py(p.low).toFixed(1)}V${py(p.high).toFixed(1)}`] : [],
  );
  const dots = points.map(
    ([x, y]) => `<circle cx="${px(x).toFixed(1)}" cy="${py(y).toFixed(1)}" r="2.4" fill="${paint}"/>`,
  );
  const names = points.map(([x, y], i) =>
    s.names
      ? `<text x="${px(x).toFixed(1)}" y="${(py(y) + (i % 2 ? 18 : -9)).toFixed(1)}" text-anchor="middle">${escaped(s.names[i] ?? "")}</text>`
      : "",
  );
  return [`<path d="${bars.join("")}" stroke="${paint}" stroke-opacity="0.35"/>`, ...dots, ...names];
}
