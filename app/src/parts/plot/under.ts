// What stands behind and beside the lines of a plot: intervals, what is beyond the scale, marks.
import type uPlot from "uplot";
import { colour } from "../../shell/theme";
import type { PlotData, Series } from "./series";

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

/** Names of points, above and below by turns, as neighbours may stand close. */
function names(c: Canvas, s: Series): void {
  const ratio = devicePixelRatio;
  c.ctx.font = `${12 * ratio}px system-ui, sans-serif`;
  c.ctx.textAlign = "center";
  [c.ctx.fillStyle, c.ctx.strokeStyle, c.ctx.lineWidth] = [colour(s.colour), colour("paper"), 3 * ratio];
  s.names?.forEach((name, i) => {
    const half = c.ctx.measureText(name).width / 2;
    const x = Math.min(Math.max(c.px(s.x[i] ?? NaN), c.left + half), c.left + c.width - half);
    const y = Math.min(c.py(s.y[i] ?? NaN) + (i % 2 ? 18 : -9) * ratio, c.top + c.height - 3 * ratio);
    c.ctx.strokeText(name, x, y);
    c.ctx.fillText(name, x, y);
  });
}

function marks(u: uPlot, c: Canvas, data: PlotData): void {
  const ratio = devicePixelRatio;
  c.ctx.font = `${12 * ratio}px system-ui, sans-serif`;
  const free = [-Infinity, -Infinity, -Infinity]; // where each line of words ends
  for (const mark of data.marks?.toSorted((a, b) => a.x - b.x) ?? []) {
    const px = u.valToPos(mark.x, "x", true);
    const paint = colour(mark.colour);
    if (mark.to !== undefined) {
      c.ctx.fillStyle = paint + "22";
      c.ctx.fillRect(px, c.top, u.valToPos(mark.to, "x", true) - px, c.height);
    }
    c.ctx.strokeStyle = paint;
    c.ctx.setLineDash([4 * ratio, 3 * ratio]);
    c.ctx.lineWidth = ratio;
    c.ctx.beginPath();
    c.ctx.moveTo(px, c.top);
    c.ctx.lineTo(px, c.top + c.height);
    c.ctx.stroke();
    c.ctx.setLineDash([]);
    const width = c.ctx.measureText(mark.words).width;
    const turned = px + width + 8 * ratio > c.left + c.width;
    const line = free.findIndex((end) => (turned ? px - width : px) > end);
    if (px >= c.left && px <= c.left + c.width && line >= 0) {
      c.ctx.fillStyle = paint;
      c.ctx.textAlign = turned ? "right" : "left";
      c.ctx.fillText(mark.words, px + (turned ? -5 : 5) * ratio, c.top + (13 + 15 * line) * ratio);
      free[line] = px + (turned ? 0 : width + 8 * ratio);
    }
  }
}

export function under(of: () => PlotData): uPlot.Plugin {
  const drawn = (what: (u: uPlot, c: Canvas, data: PlotData) => void) => (u: uPlot) => {
    const { ctx } = u;
    const data = of();
    const { left, top, width, height } = u.bbox;
    const px = scaleOf(u, "x", data.logX ?? false, left, left + width);
    const py = scaleOf(u, "y", data.log ?? false, top + height, top);
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    what(u, { ctx, ...u.bbox, px, py }, data);
    ctx.restore();
  };
  const behind = drawn((u, c, data) => {
    for (const s of data.series) {
      if (s.kind !== "points") continue;
      intervals(c, s);
      beyond(c, s);
    }
    marks(u, c, data);
  });
  return { hooks: { drawAxes: behind, draw: drawn((_, c, data) => data.series.forEach((s) => names(c, s))) } };
}
