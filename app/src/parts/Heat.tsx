// A number for each cell of a grid, as a picture: brighter is more.
import { useMemo, useRef, useState } from "preact/hooks";
import { raised } from "../words/numbers";
import { colour, theme } from "../shell/theme";
import { SaveDrawn } from "./plot/SaveMenu";
import { csvFrom, ticksOf } from "./plot/series";
import { useWidth } from "./width";

const [LEFT, RIGHT, TOP, BOTTOM] = [66, 14, 24, 44];
/** Cividis (Nuñez, Anderton & Renslow 2018), as the report's. */
const CIVIDIS = ["#002255", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55", "#fee838"]; // prettier-ignore

type Ends = readonly [number, number];
export interface HeatProps {
  title: string;
  unit: string;
  /** What a cell holds, with its unit. */
  zName: string;
  /** Whether the axes count decades. */
  decades?: boolean;
  /** Rows from the lowest y on. */
  cells: readonly (readonly (number | null)[])[];
  x: Ends;
  y: Ends;
  xName: string;
  yName: string;
  sayX: (x: number) => string;
  sayY: (y: number) => string;
  say: (row: number, column: number) => string;
  cross?: Ends | null;
}

/** The least and the greatest of a grid. */
export function extremes(cells: HeatProps["cells"]): Ends {
  const known = cells.flat().filter((v): v is number => v !== null);
  return [known.reduce((a, b) => Math.min(a, b), Infinity), known.reduce((a, b) => Math.max(a, b), -Infinity)];
}

/** The grid as an image of one pixel a cell. */
function picture(cells: HeatProps["cells"]): string {
  const [low, high] = extremes(cells);
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [cells[0]?.length ?? 1, cells.length];
  const ink = sheet.getContext("2d");
  cells.forEach((row, j) =>
    row.forEach((v, i) => {
      if (!ink || v === null) return;
      ink.fillStyle = CIVIDIS[Math.round(((v - low) / (high - low || 1)) * (CIVIDIS.length - 1))] ?? "#000";
      ink.fillRect(i, cells.length - 1 - j, 1, 1);
    }),
  );
  return sheet.toDataURL();
}

const whole = ([low, high]: Ends): number[] =>
  Array.from({ length: Math.floor(high) - Math.ceil(low) + 1 }, (_, k) => Math.ceil(low) + k);

/** One line a cell: its middle and what it holds. */
function csvOf({ cells, x, y, decades, xName, yName, zName }: HeatProps): string {
  const at = ([from, to]: Ends, k: number, n: number): number => {
    const value = from + ((k + 0.5) / n) * (to - from);
    return Number((decades ? 10 ** value : value).toPrecision(6));
  };
  const lines = cells.flatMap((row, j) => row.map((v, i) => [at(x, i, row.length), at(y, j, cells.length), v]));
  return csvFrom([[xName, yName, zName], ...lines]);
}

export function Heat(p: HeatProps) {
  const [quiet] = [colour("quiet"), theme.value];
  const [read, setRead] = useState("");
  const href = useMemo(() => picture(p.cells), [p.cells]);
  const root = useRef<HTMLElement>(null);
  const [width, height] = [useWidth(root), 360];
  const [wide, high] = [Math.max(width - LEFT - RIGHT, 0), height - TOP - BOTTOM];
  const px = (v: number): number => LEFT + ((v - p.x[0]) / (p.x[1] - p.x[0] || 1)) * wide;
  const py = (v: number): number => height - BOTTOM - ((v - p.y[0]) / (p.y[1] - p.y[0] || 1)) * high;
  const point = (event: MouseEvent): void => {
    const box = (event.currentTarget as Element).getBoundingClientRect();
    const [across, up] = [(event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height];
    const [row, column] = [Math.floor(up * p.cells.length), Math.floor(across * (p.cells[0]?.length ?? 0))];
    setRead(p.cells[row]?.[column] === undefined ? "" : p.say(row, column));
  };
  return (
    <figure class="plot" ref={root}>
      <figcaption>
        <b>{p.title}</b>
        <span class="unit">{raised(p.unit)}</span>
        <output>{read}</output>
        <SaveDrawn title={p.title} csv={() => csvOf(p)} />
      </figcaption>
      <svg
        class="surface drawn"
        {...{ width, height, viewBox: `0 0 ${width} ${height}` }}
        {...{ fill: quiet, "font-size": 12, "font-family": "system-ui, sans-serif", "image-rendering": "pixelated" }}
        role="img"
        aria-label={`${p.title}, ${p.unit}`}
      >
        <image
          {...{ href, x: LEFT, y: TOP, width: wide, height: high, preserveAspectRatio: "none" }}
          onMouseMove={point}
          onMouseLeave={() => setRead("")}
        />
        {(p.decades ? whole(p.x) : ticksOf([...p.x], 6)).map((v) => (
          <text key={v} x={px(v)} y={height - BOTTOM + 18} text-anchor="middle">
            {p.sayX(v)}
          </text>
        ))}
        {(p.decades ? whole(p.y) : ticksOf([...p.y], 5)).map((v) => (
          <text key={v} x={LEFT - 6} y={py(v) + 4} text-anchor="end">
            {p.sayY(v)}
          </text>
        ))}
        <text x={width - RIGHT} y={height - 6} text-anchor="end">
          {p.xName} →
        </text>
        <text x={LEFT} y={TOP - 9}>
          ↑ {p.yName}
        </text>
        {p.cross && (
          <path
            class="cross"
            stroke="#fff"
            stroke-width="3"
            fill="none"
            d={`M${px(p.cross[0]) - 9} ${py(p.cross[1])}h18m-9 -9v18`}
          />
        )}
      </svg>
    </figure>
  );
}
