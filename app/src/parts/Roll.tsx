// Signals that roll: samples by channel, the newest at the right, drawn with every frame of the screen.
import { useEffect, useRef } from "preact/hooks";
import { colour, theme } from "../shell/theme";
import { PAINTS } from "./modes";

const KEPT_S = 240;
const LANE_PX = [22, 56] as const;
const NAMES_PX = 92;

interface Piece {
  from: number;
  step: number;
  values: readonly (number | null)[];
}

/** What arrived of each channel, and the clock that it is shown by. */
export class Roll {
  readonly channels = new Map<string, Piece[]>();
  streams = false;
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
    if (this.streams && Math.abs(end - this.now()) > 3) this.zero += end - this.now(); // a clock that jumped
    while (pieces[0] && pieces[0].from + pieces[0].step * pieces[0].values.length < end - KEPT_S) pieces.shift();
  }
}

type Ink = CanvasRenderingContext2D;
/** Draw a channel between its extremes, and say these. */
function lane(ink: Ink, pieces: Piece[], now: number, span: number, box: number[]): string {
  const [left = 0, top = 0, width = 0, height = 0] = box;
  let [least, most] = [Infinity, -Infinity];
  const shown = pieces.map((p): [Piece, number, number] => [
    p,
    Math.max(0, Math.floor((now - span - p.from) / p.step)),
    Math.min(p.values.length, Math.ceil((now - p.from) / p.step)),
  ]);
  for (const [p, a, b] of shown)
    for (let i = a; i < b; i++) {
      const v = p.values[i] ?? NaN;
      if (v < least) least = v;
      if (v > most) most = v;
    }
  ink.beginPath();
  for (const [p, a, b] of shown) {
    let pen = false;
    for (let i = a; i < b; i++) {
      const v = p.values[i];
      const x = left + width * (1 - (now - p.from - i * p.step) / span);
      if (typeof v === "number")
        ink[pen ? "lineTo" : "moveTo"](x, top + height * (0.95 - (0.9 * (v - least)) / (most - least || 1)));
      pen = typeof v === "number";
    }
  }
  ink.stroke();
  return least < most ? `${least.toPrecision(2)} to ${most.toPrecision(2)}` : "";
}

export function Lanes({ roll, span }: { roll: Roll; span: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const dark = theme.value;
  useEffect(() => {
    const sheet = canvas.current;
    const ink = sheet?.getContext("2d");
    if (!sheet || !ink) return;
    const [quiet = "", ...paints] = ["quiet", ...PAINTS].map(colour); // asking costs a layout
    let frame = 0;
    let count = 0;
    const draw = (): void => {
      const names = [...roll.channels.keys()];
      const each = Math.max(LANE_PX[0], Math.min(LANE_PX[1], 620 / Math.max(names.length, 1)));
      const [width, height] = [sheet.clientWidth, Math.max(each * names.length, 120)];
      const ratio = devicePixelRatio;
      if (sheet.width !== Math.round(width * ratio) || sheet.height !== Math.round(height * ratio)) {
        [sheet.width, sheet.height] = [Math.round(width * ratio), Math.round(height * ratio)];
        sheet.style.height = `${height}px`;
      }
      ink.setTransform(ratio, 0, 0, ratio, 0, 0);
      ink.clearRect(0, 0, width, height);
      ink.font = "12px system-ui, sans-serif";
      names.forEach((name, k) => {
        ink.strokeStyle = paints[k % paints.length] ?? quiet;
        const said = lane(ink, roll.channels.get(name) ?? [], roll.now(), span, [
          NAMES_PX,
          k * each,
          width - NAMES_PX,
          each,
        ]);
        ink.fillStyle = quiet;
        ink.fillText(name.slice(0, 13), 0, (k + 0.5) * each + 4);
        if (each > 40) ink.fillText(said, 0, (k + 0.5) * each + 18);
      });
      sheet.dataset["frames"] = String(++count);
      frame = requestAnimationFrame(draw);
    };
    draw();
    return () => cancelAnimationFrame(frame);
  }, [roll, span, dark]);
  return <canvas class="lanes" ref={canvas} role="img" aria-label={`Signals of the last ${span} s`} />;
}
