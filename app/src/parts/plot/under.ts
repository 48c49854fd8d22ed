// What stands behind and beside the lines of a plot: intervals, what is beyond the scale, marks.
import type uPlot from "uplot";
import { colour } from "../../shell/theme";
import { type PlotData, type Series, wordsOf } from "./series";

type Scale = (v: number) => number;
type Canvas = uPlot.BBox & { ctx: CanvasRenderingContext2D; px: Scale; py: Scale };

/** A straight scale in place of uPlot's own, which asks what it is for every point. */
function scaleOf(u: uPlot, name: "x" | "y", log: boolean, from: number, to: number): Scale {
  const { min, max } = u.scales[name] ?? {};
  const of: Scale = log ? Math.log10 : (v) => v;
  const [a, b] = [of(min ?? 0), of(max ?? 1)];
  const factor = (to - from) / (b - a || 1);
  return log ? (v) => from + (Math.log10(v) - a) * factor : (v) => from + (v - a) * factor;
}

function intervals(c: Canvas, s: Series): void {
  if (!s.low || !s.high) return;
  c.ctx.strokeStyle = colour(s.colour) + (s.x.length > 300 ? "3a" : "77");
  c.ctx.lineWidth = devicePixelRatio;
  c.ctx.beginPath();
  for (let i = 0; i < s.x.length; i++) bar(c, c.px(s.x[i] ?? NaN), s.low[i], s.high[i]);
  c.ctx.stroke();
}

function bar(c: Canvas, x: number, low: number | null | undefined, high: number | null | undefined): void {
  if (typeof low !== "number" || typeof high !== "number" || !(x >= c.left && x <= c.left + c.width)) return;
  c.ctx.moveTo(x, c.py(low));
  c.ctx.lineTo(x, c.py(high));
}

/** Points beyond the scale: triangles at its edge. */
function beyond(c: Canvas, s: Series): void {
  const [r, bottom] = [4 * devicePixelRatio, c.top + c.height];
  c.ctx.fillStyle = colour(s.colour);
  c.ctx.beginPath();
  for (let i = 0; i < s.x.length; i++) {
    const [x, y] = [c.px(s.x[i] ?? NaN), c.py(s.y[i] ?? NaN)];
    if (!(x >= c.left && x <= c.left + c.width) || !(y < c.top || y > bottom)) continue;
    const [edge, foot] = y < c.top ? [c.top, c.top + 2 * r] : [bottom, bottom - 2 * r];
    c.ctx.moveTo(x, edge);
    for (const side of [x - r, x + r]) c.ctx.lineTo(side, foot);
  }
  c.ctx.fill();
}

/** Words in front of lines: with a rim of paper around them. */
function write(c: Canvas, text: string, paint: string, x: number, y: number): void {
  [c.ctx.fillStyle, c.ctx.strokeStyle, c.ctx.lineWidth] = [paint, colour("paper"), 3 * devicePixelRatio];
  c.ctx.strokeText(text, x, y);
  c.ctx.fillText(text, x, y);
}

const BESIDE_PX = [-9, 18, -24, 33, -39, 48];
/** Names of points, above or below them where no other name is. */
function names(c: Canvas, s: Series): void {
  const [ratio, taken] = [devicePixelRatio, [] as [number, number, number][]];
  c.ctx.textAlign = "center";
  s.names?.forEach((name, i) => {
    const half = c.ctx.measureText(name).width / 2 + 2 * ratio;
    const x = Math.min(Math.max(c.px(s.x[i] ?? NaN), c.left + half), c.left + c.width - half);
    const places = BESIDE_PX.map((by) => c.py(s.y[i] ?? NaN) + by * ratio);
    const inside = places.filter((y) => y > c.top + 10 * ratio && y < c.top + c.height - 2 * ratio);
    const apart = (y: number, one: (typeof taken)[0]): boolean =>
      Math.abs(x - one[0]) > half + one[2] || Math.abs(y - one[1]) > 13 * ratio;
    const y = inside.find((place) => taken.every((one) => apart(place, one))) ?? inside[0] ?? NaN;
    taken.push([x, y, half]);
    write(c, name, colour(s.colour), x, y);
  });
}

function marks(c: Canvas, { marks = [] }: PlotData): void {
  const ratio = devicePixelRatio;
  for (const mark of marks) {
    const px = c.px(mark.x);
    const paint = colour(mark.colour);
    if (mark.to !== undefined) {
      c.ctx.fillStyle = paint + "22";
      c.ctx.fillRect(px, c.top, c.px(mark.to) - px, c.height);
    }
    c.ctx.strokeStyle = paint;
    c.ctx.setLineDash([4 * ratio, 3 * ratio]);
    c.ctx.lineWidth = ratio;
    c.ctx.beginPath();
    c.ctx.moveTo(px, c.top);
    c.ctx.lineTo(px, c.top + c.height);
    c.ctx.stroke();
    c.ctx.setLineDash([]);
  }
}

/** What the marks say, in front of all lines. */
function said(c: Canvas, { marks }: PlotData): void {
  const ratio = devicePixelRatio;
  c.ctx.textAlign = "left";
  const wide = (words: string): number => c.ctx.measureText(words).width + 8 * ratio;
  for (const { words, colour: paint, at, line } of wordsOf(marks, c.px, wide, [c.left, c.left + c.width]))
    write(c, words, colour(paint), at + 4 * ratio, c.top + (13 + 15 * line) * ratio);
}

export function under(of: () => PlotData): uPlot.Plugin {
  const drawn = (what: (c: Canvas, data: PlotData) => void) => (u: uPlot) => {
    const { ctx } = u;
    const data = of();
    const { left, top, width, height } = u.bbox;
    const px = scaleOf(u, "x", data.logX ?? false, left, left + width);
    const py = scaleOf(u, "y", data.log ?? false, top + height, top);
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    what({ ctx, ...u.bbox, px, py }, data);
    ctx.restore();
  };
  const behind = drawn((c, data) => {
    for (const s of data.series) {
      if (s.kind !== "points") continue;
      intervals(c, s);
      beyond(c, s);
    }
    marks(c, data);
  });
  const front = drawn((c, data) => {
    c.ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    data.series.forEach((s) => names(c, s));
    said(c, data);
  });
  return { hooks: { drawAxes: behind, draw: front } };
}
