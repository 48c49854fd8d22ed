// Signals that roll: samples by channel, the newest at the right, drawn with every frame of the screen.
import { useLayoutEffect, useRef } from "preact/hooks";
import { colour, theme } from "../shell/theme";
import { minus } from "../words/numbers";
import { PAINTS } from "./modes";
import { csvFrom, stamp } from "./plot/series";

const KEPT_S = 240;
const [LEAST_PX, MOST_PX, PHONE_PX, ROOM_PX] = [22, 84, 56, 760];
const NAMES_PX = 140;

type Piece = { from: number; step: number; values: readonly (number | null)[] };

/** What arrived of each channel, and the clock that it is shown by. */
export class Roll {
  readonly channels = new Map<string, Piece[]>();
  streams = false;
  units: Record<string, string> = {};
  private zero = 0;
  private started = performance.now();

  /** Begin anew at a moment of the samples' own clock. */
  begin(at: number, streams: boolean): void {
    this.channels.clear();
    [this.zero, this.streams, this.started] = [at, streams, performance.now()];
  }
  now(): number {
    return this.zero + (performance.now() - this.started) / 1000;
  }
  add(channel: string, from: number, step: number, values: Piece["values"]): void {
    const pieces = this.channels.get(channel) ?? [];
    this.channels.set(channel, pieces);
    pieces.push({ from, step, values });
    const end = from + step * values.length;
    if (this.streams && Math.abs(from - this.now()) > 3) this.zero += from - this.now(); // a clock that jumped
    while (pieces[0] && pieces[0].from + pieces[0].step * pieces[0].values.length < end - KEPT_S) pieces.shift();
  }
  /** The samples of the last seconds, a line each. */
  csv(span: number): string {
    const [until, time] = [this.now(), this.streams ? stamp : (t: number): number => Number(t.toFixed(4))];
    const rows = [...this.channels].flatMap(([name, pieces]) =>
      pieces.flatMap(({ from, step, values }) => values.map((v, i) => [name, from + i * step, v] as const)),
    );
    const shown = rows.filter(([, t]) => t > until - span && t <= until);
    return csvFrom([
      ["channel", this.streams ? "time_utc" : "seconds", "value"],
      ...shown.map(([name, t, v]) => [name, time(t), v]),
    ]);
  }
}

type Numbers = Record<"now" | "span" | "left" | "right" | "ratio", number>;
type Sheet = Numbers & { ink: CanvasRenderingContext2D; quiet: string; units: Roll["units"] };
interface Lane {
  name: string;
  paint: string;
  low: number;
  high: number;
  /** The last sample that is drawn. */
  until: number;
}
const SHRINKS = 0.7;

/** Draw of a channel what came since the last frame; all of it, with its name, where its extremes are others. */
function draw(on: Sheet, pieces: Piece[], lane: Lane, top: number, height: number): void {
  const { ink, now, span, left, right, ratio } = on;
  let [least, most] = [Infinity, -Infinity];
  const place = (p: Piece, t: number): number =>
    Math.min(p.values.length, Math.max(0, Math.floor((t - p.from) / p.step)));
  for (const p of pieces)
    for (let i = place(p, now - span), b = place(p, now); i < b; i++) {
      const v = p.values[i] ?? NaN;
      if (v < least) least = v;
      if (v > most) most = v;
    }
  if (least < lane.low || most > lane.high || most - least < SHRINKS * (lane.high - lane.low)) {
    [lane.low, lane.high, lane.until] = [least, most, -Infinity];
    ink.clearRect(0, top, left, height);
    ink.fillStyle = on.quiet;
    ink.fillText(lane.name.slice(0, 13), 0, top + height / 2 + 4 * ratio);
    const said = minus(`${least.toPrecision(2)} to ${most.toPrecision(2)} ${on.units[lane.name] ?? ""}`);
    if (height > 40 * ratio && least < most) ink.fillText(said, 0, top + height / 2 + 18 * ratio);
  }
  const x = (t: number): number => right - ((right - left) * (now - t)) / span;
  const edge = Math.max(left, Math.floor(x(lane.until)) - 1); // a line is wider than its samples
  const from = now - ((right - edge) * span) / (right - left);
  const scale = (0.9 * height) / (lane.high - lane.low || 1);
  ink.save();
  ink.beginPath();
  ink.rect(edge, top, right, height);
  ink.clip();
  ink.clearRect(left, top, right, height);
  ink.strokeStyle = lane.paint;
  ink.beginPath();
  let end = -Infinity;
  for (const p of pieces) {
    let pen = p.from - end < 1.5 * p.step;
    for (let i = Math.max(0, place(p, from) - 1), b = place(p, now); i < b; i++) {
      const v = p.values[i];
      end = p.from + i * p.step;
      if (typeof v === "number") ink[pen ? "lineTo" : "moveTo"](x(end), top + 0.95 * height - scale * (v - lane.low));
      pen = typeof v === "number";
    }
  }
  ink.stroke();
  ink.restore();
  if (end > lane.until) lane.until = end;
}

/** Signals that move to the left by whole pixels: of each frame only what is new is drawn. */
export function Lanes({ roll, span }: { roll: Roll; span: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const dark = theme.value;
  useLayoutEffect(() => {
    const sheet = canvas.current;
    const ink = sheet?.getContext("2d");
    if (!sheet || !ink) return;
    const [quiet = "", ...paints] = ["quiet", ...PAINTS].map(colour); // asking costs a layout
    const ratio = devicePixelRatio;
    const left = Math.round(NAMES_PX * ratio);
    let [frame, count, column, was] = [0, 0, 0, ""];
    let lanes: Lane[] = [];
    const next = (): void => {
      const names = [...roll.channels.keys()];
      const most = sheet.clientWidth < 480 ? PHONE_PX : MOST_PX;
      const each = Math.round(ratio * Math.max(LEAST_PX, Math.min(most, ROOM_PX / Math.max(names.length, 1))));
      const [width, height] = [Math.round(sheet.clientWidth * ratio), Math.max(each * names.length, 120 * ratio)];
      const step = span / (width - left);
      const moved = Math.floor(roll.now() / step) - column;
      column += moved;
      const shown = [width, height, roll.streams, ...names].join();
      if (shown !== was || moved < 0) {
        [sheet.width, sheet.height, was] = [width, height, shown]; // which clears it
        sheet.style.height = `${height / ratio}px`;
        [ink.font, ink.lineWidth] = [`${12 * ratio}px system-ui, sans-serif`, ratio];
        lanes = names.map((name, k) => {
          return { name, paint: paints[k % paints.length] ?? quiet, low: 0, high: -1, until: -Infinity };
        });
      } else if (moved) {
        ink.save();
        ink.beginPath();
        ink.rect(left, 0, width, height);
        ink.clip();
        ink.globalCompositeOperation = "copy";
        ink.drawImage(sheet, -moved, 0);
        ink.restore();
      }
      const on = { ink, now: column * step, span, left, right: width, ratio, quiet, units: roll.units };
      lanes.forEach((lane, k) => draw(on, roll.channels.get(lane.name) ?? [], lane, k * each, each));
      sheet.dataset["frames"] = String(++count);
      frame = requestAnimationFrame(next);
    };
    next();
    return () => cancelAnimationFrame(frame);
  }, [roll, span, dark]);
  return (
    <>
      <canvas class="lanes drawn" ref={canvas} role="img" aria-label={`Signals of the last ${span} s`} />
      <p class="ends">
        −{span} s <span>now</span>
      </p>
    </>
  );
}
