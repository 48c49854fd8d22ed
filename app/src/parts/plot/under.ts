// What stands behind and beside the lines of a plot: intervals, many points, marks.
import type uPlot from "uplot";
import { colour } from "../../shell/theme";
import type { PlotData, Series } from "./series";

/** More points than this are squares without intervals of their own: each pixel is painted once. */
export const MANY = 1500;

interface Canvas {
  ctx: CanvasRenderingContext2D;
  px: (x: number) => number;
  py: (y: number) => number;
  left: number;
  top: number;
  width: number;
  height: number;
}

/** A straight scale in place of uPlot's own, which asks what it is for every point. */
function scaleOf(u: uPlot, name: "x" | "y", log: boolean, from: number, to: number): (v: number) => number {
  const { min, max } = u.scales[name] ?? {};
  const of = log ? Math.log10 : (v: number): number => v;
  const [a, b] = [of(min ?? 0), of(max ?? 1)];
  const factor = (to - from) / (b - a || 1);
  return log ? (v) => from + (Math.log10(v) - a) * factor : (v) => from + (v - a) * factor;
}

function intervals(c: Canvas, s: Series): void {
  if (!s.low || !s.high) return;
  c.ctx.strokeStyle = colour(s.colour) + (s.x.length > 300 ? "3a" : "77");
  c.ctx.lineWidth = devicePixelRatio;
  c.ctx.beginPath();
  if (s.x.length <= MANY) {
    for (let i = 0; i < s.x.length; i++) bar(c, c.px(s.x[i] ?? NaN), s.low[i], s.high[i]);
  } else {
    const width = Math.ceil(c.width) + 1;
    const [low, high] = [new Float64Array(width).fill(Infinity), new Float64Array(width).fill(-Infinity)];
    for (let i = 0; i < s.x.length; i++) {
      const column = Math.round(c.px(s.x[i] ?? NaN) - c.left);
      const [a, b] = [s.low[i], s.high[i]];
      if (!(column >= 0 && column < width) || typeof a !== "number" || typeof b !== "number") continue;
      if (a < (low[column] ?? 0)) low[column] = a;
      if (b > (high[column] ?? 0)) high[column] = b;
    }
    for (let k = 0; k < width; k++) if (high[k] !== -Infinity) bar(c, c.left + k, low[k], high[k]);
  }
  c.ctx.stroke();
}

function bar(c: Canvas, x: number, low: number | null | undefined, high: number | null | undefined): void {
  if (typeof low !== "number" || typeof high !== "number" || !(x >= c.left && x <= c.left + c.width)) return;
  c.ctx.moveTo(x, c.py(low));
  c.ctx.lineTo(x, c.py(high));
}

function squares(c: Canvas, s: Series): void {
  const size = Math.max(Math.round(2 * devicePixelRatio), 2);
  const [width, height] = [Math.ceil(c.width) + 1, Math.ceil(c.height) + 1];
  const painted = new Uint8Array(width * height);
  c.ctx.fillStyle = colour(s.colour);
  for (let i = 0; i < s.x.length; i++) {
    const y = s.y[i];
    if (typeof y !== "number") continue;
    const [left, top] = [Math.round(c.px(s.x[i] ?? NaN) - c.left), Math.round(c.py(y) - c.top)];
    if (!(left >= 0 && left < width && top >= 0 && top < height) || painted[top * width + left]) continue;
    painted[top * width + left] = 1;
    c.ctx.fillRect(c.left + left - size / 2, c.top + top - size / 2, size, size);
  }
}

function marks(u: uPlot, c: Canvas, data: PlotData): void {
  const ratio = devicePixelRatio;
  c.ctx.font = `${12 * ratio}px system-ui, sans-serif`;
  let free = -Infinity;
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
    if (px >= c.left && px <= c.left + c.width && px > free) {
      c.ctx.fillStyle = paint;
      c.ctx.textAlign = turned ? "right" : "left";
      c.ctx.fillText(mark.words, px + (turned ? -5 : 5) * ratio, c.top + 13 * ratio);
      free = px + (turned ? 0 : width);
    }
  }
}

export function under(of: () => PlotData): uPlot.Plugin {
  const draw = (u: uPlot): void => {
    const { ctx } = u;
    const data = of();
    const { left, top, width, height } = u.bbox;
    const c: Canvas = {
      ctx,
      left,
      top,
      width,
      height,
      px: scaleOf(u, "x", data.logX ?? false, left, left + width),
      py: scaleOf(u, "y", data.log ?? false, top + height, top),
    };
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    for (const s of data.series) {
      if (s.kind !== "points") continue;
      intervals(c, s);
      if (s.x.length > MANY) squares(c, s);
    }
    marks(u, c, data);
    ctx.restore();
  };
  return { hooks: { drawAxes: draw } };
}
