// The cost over two parameters, both axes in decades; brighter is nearer to what was measured.
import { useMemo } from "preact/hooks";
import type { Schemas } from "../api/client";
import { quantity } from "../words/numbers";
import { Heat } from "./Heat";

interface SurfaceProps {
  surface: Schemas["SurfaceOut"];
  at: Record<string, number>;
  unit: (parameter: string) => string;
  said: (parameter: string) => string;
}

/** First and last of some values, in decades. */
const ends = (v: readonly number[]): [number, number] => [Math.log10(v[0] ?? 1), Math.log10(v.at(-1) ?? 10)];
const decades = ([low, high]: readonly [number, number]): number[] =>
  Array.from({ length: Math.floor(high) - Math.ceil(low) + 1 }, (_, k) => Math.ceil(low) + k);

export function Surface({ surface, at, unit, said }: SurfaceProps) {
  const { x, y, cost } = surface;
  const cells = useMemo(() => cost.map((row) => row.map((v) => (v ? -Math.log10(v) : null))), [cost]);
  const tick = (axis: typeof x) => (v: number) => quantity(10 ** v, unit(axis.parameter));
  const known = cost.flat().filter((v): v is number => v !== null && v > 0);
  const [ax, ay] = [at[x.parameter], at[y.parameter]];
  return (
    <Heat
      title="Cost over two parameters"
      unit={`from ${Math.min(...known).toPrecision(2)} (bright) to ${Math.max(...known).toPrecision(2)} (dark)`}
      cells={cells}
      zName="-log10 of the cost"
      decades
      x={ends(x.values)}
      y={ends(y.values)}
      xTicks={decades(ends(x.values))}
      yTicks={decades(ends(y.values))}
      xName={said(x.parameter)}
      yName={said(y.parameter)}
      sayX={tick(x)}
      sayY={tick(y)}
      say={(j, i) =>
        `${said(x.parameter)} ${quantity(x.values[i], unit(x.parameter))}, ${said(y.parameter)} ${quantity(y.values[j], unit(y.parameter))}: cost ${cost[j]?.[i]?.toPrecision(3) ?? "unknown"}`
      }
      cross={ax && ay ? [Math.log10(ax), Math.log10(ay)] : null}
    />
  );
}
