// The cost over two parameters: a cell a value, both axes in decades; brighter is nearer to what was measured.
import { useState } from "preact/hooks";
import type { Schemas } from "../api/client";
import { quantity } from "../words/numbers";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [560, 400, 66, 14, 10, 44];
/** Cividis (Nuñez, Anderton & Renslow 2018), as the report's, from far to near. */
const CIVIDIS = ["#002255", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55", "#fee838"]; // prettier-ignore

interface SurfaceProps {
  surface: Schemas["SurfaceOut"];
  at: Record<string, number>;
  unit: (parameter: string) => string;
}

/** Places between values, in decades: where cells meet. */
function edges(values: readonly number[]): number[] {
  const log = values.map(Math.log10);
  const middle = log.slice(1).map((v, i) => (v + (log[i] ?? v)) / 2);
  return [log[0] ?? 0, ...middle, log[log.length - 1] ?? 1];
}

export function Surface({ surface, at, unit }: SurfaceProps) {
  const [read, setRead] = useState("");
  const { x, y, cost } = surface;
  const [ex, ey] = [edges(x.values), edges(y.values)];
  const span = (e: number[], v: number): number =>
    (v - (e[0] ?? 0)) / ((e[e.length - 1] ?? 1) - (e[0] ?? 0) || 1);
  const px = (v: number): number => LEFT + span(ex, v) * (WIDTH - LEFT - RIGHT);
  const py = (v: number): number => HEIGHT - BOTTOM - span(ey, v) * (HEIGHT - TOP - BOTTOM);
  const known = cost.flat().filter((v): v is number => v !== null && v > 0);
  const [low, high] = [Math.log10(Math.min(...known)), Math.log10(Math.max(...known))];
  const paint = (v: number | null): string => {
    if (v === null) return "none";
    const far = (Math.log10(Math.max(v, 10 ** low)) - low) / (high - low || 1);
    return CIVIDIS[Math.round((1 - far) * (CIVIDIS.length - 1))] ?? "none";
  };
  const say = (i: number, j: number): string =>
    `${x.parameter} ${quantity(x.values[i], unit(x.parameter))}, ${y.parameter} ${quantity(y.values[j], unit(y.parameter))}: cost ${cost[j]?.[i]?.toPrecision(3) ?? "unknown"}`;
  const decades = (e: number[]): number[] => {
    const found = [];
    for (let d = Math.ceil(e[0] ?? 0); d <= (e[e.length - 1] ?? 0); d++) found.push(d);
    return found;
  };
  const [ax, ay] = [at[x.parameter], at[y.parameter]];
  return (
    <figure class="plot">
      <figcaption>
        <b>Cost over two parameters</b>
        <span class="unit">
          from {(10 ** low).toPrecision(2)} (bright) to {(10 ** high).toPrecision(2)} (dark)
        </span>
        <output>{read}</output>
      </figcaption>
      <svg
        class="surface"
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        role="img"
        aria-label={`Cost over ${x.parameter} and ${y.parameter}; the cross is where the medians are`}
        onMouseLeave={() => setRead("")}
      >
        {cost.map((row, j) =>
          row.map((v, i) => (
            <rect
              key={`${i} ${j}`}
              x={px(ex[i] ?? 0)}
              y={py(ey[j + 1] ?? 0)}
              width={px(ex[i + 1] ?? 0) - px(ex[i] ?? 0) + 0.4}
              height={py(ey[j] ?? 0) - py(ey[j + 1] ?? 0) + 0.4}
              fill={paint(v)}
              onMouseEnter={() => setRead(say(i, j))}
            />
          )),
        )}
        {decades(ex).map((d) => (
          <text key={d} x={px(d)} y={HEIGHT - BOTTOM + 18} text-anchor="middle">
            {quantity(10 ** d, unit(x.parameter))}
          </text>
        ))}
        {decades(ey).map((d) => (
          <text key={d} x={LEFT - 6} y={py(d) + 4} text-anchor="end">
            {quantity(10 ** d, unit(y.parameter))}
          </text>
        ))}
        <text x={WIDTH - RIGHT} y={HEIGHT - 6} text-anchor="end">
          {x.parameter} →
        </text>
        <text x={LEFT + 6} y={TOP + 14} class="over">
          ↑ {y.parameter}
        </text>
        {ax && ay ? (
          <path class="cross" d={`M${px(Math.log10(ax)) - 9} ${py(Math.log10(ay))}h18m-9 -9v18`} />
        ) : null}
      </svg>
    </figure>
  );
}
