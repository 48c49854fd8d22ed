// A plot: uPlot with our colours, UTC, intervals, marks, keyboard, and a copy to take away.
import { useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { asked, keep, keepStretch, stretch, useStrange } from "../../shell/place";
import { colour, theme } from "../../shell/theme";
import { onAxis, raised, short } from "../../words/numbers";
import { here } from "../../words/time";
import { useWidth } from "../width";
import { SaveMenu, sheetOf } from "./SaveMenu";
import type { PlotData, Range, Series } from "./series";
import { csvOf, extentOf, readX, spanOf, ticksOf } from "./series";
import { svgOf } from "./svg";
import { under } from "./under";

interface PlotProps {
  data: PlotData;
  height?: number;
  /** What is shown of the x axis at first, null for all; the address keeps another. */
  first?: Range | null;
  /** What to do when a point is chosen by click or Enter. */
  onPick?: (series: number, index: number) => void;
  /** Plots of one name share their cursor, and what is shown of the x axis. */
  together?: string;
}

const TIMES: uPlot.Axis.Values = [
  [3600 * 24 * 360, "{YYYY}", null, null, null, null, null, null, 1],
  [3600 * 24 * 28, "{MMM}", "\n{YYYY}", null, null, null, null, null, 1],
  [3600 * 24, "{D} {MMM}", "\n{YYYY}", null, null, null, null, null, 1],
  [60, "{HH}:{mm}", "\n{D} {MMM} {YYYY}", null, "\n{D} {MMM}", null, null, null, 1],
  [1, "{HH}:{mm}:{ss}", "\n{D} {MMM} {YYYY}", null, "\n{D} {MMM}", null, null, null, 1],
];

type Column = ArrayLike<number | null | undefined>;
const columnsOf = (s: Series, put: (values: Series["y"] | undefined) => Column): Column[] =>
  s.kind === "band" ? [put(s.high), put(s.low)] : [put(s.y)];
const rising = (x: ArrayLike<number>): boolean => {
  for (let i = 1; i < x.length; i++) if ((x[i] ?? 0) < (x[i - 1] ?? 0)) return false;
  return true;
};

/** One table for uPlot: x of all series, then y of each, the upper and lower ends of bands. */
function joined(series: Series[]): uPlot.AlignedData {
  const first = series[0]?.x ?? [];
  if (series.every((s) => s.x === first) && rising(first))
    return [first, ...series.flatMap((s) => columnsOf(s, (values) => values ?? []))] as uPlot.AlignedData;
  const every = [...new Set(series.flatMap((s) => Array.from(s.x)))].sort((a, b) => a - b);
  const place = new Map(every.map((x, i) => [x, i]));
  const spread = (s: Series, values: Series["y"] | undefined): Column => {
    const out: (number | null | undefined)[] = new Array(every.length).fill(undefined);
    for (let i = 0; i < s.x.length; i++) out[place.get(s.x[i] ?? NaN) ?? 0] = values?.[i] ?? null;
    return out;
  };
  return [every, ...series.flatMap((s) => columnsOf(s, (values) => spread(s, values)))] as uPlot.AlignedData;
}

/** What a chart is made for; of other data of the same form only the numbers are exchanged. */
const formOf = ({ xName, log, logX, series }: PlotData): string =>
  JSON.stringify([!xName, log, logX, series.map((s) => [s.kind, s.colour, s.solid, s.dash, sizeOf(s)])]);
/** Points by how large they are drawn; of lines whether they are points, too. */
const sizeOf = ({ kind, x }: Series): number =>
  kind === "band" ? 0 : kind === "line" ? Number(x.length < 3) : x.length > 200 ? 4 : 6;

function options(
  latest: { current: { data: PlotData; shown: Range } },
  width: number,
  height: number,
  more: Partial<uPlot.Options>,
): uPlot.Options {
  const { data } = latest.current;
  const [ink, line] = [colour("quiet"), colour("line")];
  const axis = {
    stroke: ink,
    grid: { stroke: line, width: 1 },
    ticks: { stroke: line, width: 1 },
    font: "12px system-ui, sans-serif",
  };
  const series: uPlot.Series[] = [{}];
  const bands: uPlot.Band[] = [];
  for (const s of data.series) {
    const paint = colour(s.colour);
    if (s.kind === "band") {
      bands.push({ series: [series.length, series.length + 1], fill: paint + (s.solid ? "cc" : "33") });
      const edge = () => ({ stroke: paint + (s.solid ? "" : "55"), width: 0.5, points: { show: false } });
      series.push(edge(), edge());
    } else if (s.kind === "points") {
      const [size, one] = [sizeOf(s), { fill: paint, stroke: paint, width: 0 }];
      series.push({ stroke: paint, paths: () => null, points: { ...one, show: size > 0, size } });
    } else {
      series.push({
        stroke: paint,
        width: 1.5,
        points: { show: sizeOf(s) > 0 },
        spanGaps: true,
        pxAlign: 0, // whole pixels make steps of what hardly rises
        ...(s.dash ? { dash: s.dash } : {}),
      });
    }
  }
  return {
    width,
    height,
    series,
    bands,
    legend: { show: false },
    tzDate: (at) => uPlot.tzDate(new Date(at * 1e3), "Etc/UTC"),
    scales: {
      x: { time: !data.xName, distr: data.logX ? 3 : 1, range: () => latest.current.shown },
      y: { distr: data.log ? 3 : 1, range: () => spanOf(latest.current.data, latest.current.shown) },
    },
    axes: [
      { ...axis, space: 70, ...(data.xName ? { ...ownTicks(data.logX), size: 30 } : { values: TIMES }) },
      {
        ...axis,
        ...ownTicks(data.log),
        size: (_u, said) => Math.max(62, ...(said ?? []).map((text) => 18 + 6.5 * text.length)),
      },
    ],
    ...more,
  };
}

export function Plot({ data, height = 220, onPick, together, first = null }: PlotProps) {
  const zoom = useZoom(together ?? data.title, first);
  const [range, onRange] = data.xName ? zoom : [stretch.value ?? first, keepStretch];
  const root = useRef<HTMLDivElement>(null);
  const width = useWidth(root);
  const chart = useRef<uPlot | null>(null);
  const [read, setRead] = useState("");
  const extent = extentOf(data);
  const shown = range ?? extent;
  const dark = theme.value;
  const table = useMemo(() => joined(data.series), [data]);
  const latest = useRef({ data, shown, onRange, onPick });
  latest.current = { data, shown, onRange, onPick };

  useLayoutEffect(() => {
    const box = root.current;
    if (!box || !width) return;
    const columns = data.series.flatMap((s, i) => (s.kind === "band" ? [-1, -1] : [i]));
    const nearest = (u: uPlot): [number, number] | null => {
      let found: [number, number, number] | null = null;
      columns.forEach((series, k) => {
        const at = u.cursor.idxs?.[k + 1];
        if (series < 0 || at === null || at === undefined) return;
        const y = u.data[k + 1]?.[at];
        if (typeof y !== "number") return;
        const far = Math.abs(u.valToPos(y, "y") - (u.cursor.top ?? 0));
        const own = latest.current.data.series[series]?.x ?? [];
        if (!found || far < found[2]) found = [series, Array.prototype.indexOf.call(own, u.data[0][at]), far];
      });
      return found && [found[0], found[1]];
    };
    const u = new uPlot(
      options(latest, width, height, {
        cursor: {
          drag: { x: true, y: false, setScale: false },
          points: { size: 7 },
          ...(together ? { sync: { key: together, scales: ["x", null] } } : {}),
          hover: { skip: [undefined, null] },
        },
        plugins: [under(() => latest.current.data)],
        hooks: {
          setSelect: [
            (self) => {
              if (self.select.width < 4) return;
              const { left, width } = self.select;
              const [a, b] = [self.posToVal(left, "x"), self.posToVal(left + width, "x")];
              self.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              latest.current.onRange([a, b]);
            },
          ],
          setCursor: [
            (self) => {
              const hit = nearest(self);
              if (!hit || (self.cursor.left ?? -1) < 0) return setRead("");
              const { data, shown } = latest.current;
              const s = data.series[hit[0]];
              if (!s) return;
              const [x, y, low, high] = [s.x[hit[1]] ?? 0, s.y[hit[1]], s.low?.[hit[1]], s.high?.[hit[1]]];
              const interval =
                typeof low === "number" && typeof high === "number" ? ` (${digits(low)} to ${digits(high)})` : "";
              const at = readX(data, x, shown[1] - shown[0]).replace("UTC", `UTC (${here(x)} here)`);
              setRead(
                `${at} · ${s.name} ${typeof y === "number" ? digits(y) : "–"}${interval}${s.said ? `, ${s.said[hit[1]]}` : ""}`,
              );
            },
          ],
          ready: [
            (self) => {
              self.over.addEventListener("dblclick", () => latest.current.onRange(null));
              const wheel = (e: WheelEvent): void => {
                const to = wheeled(self, e);
                if (to) latest.current.onRange(to);
              };
              self.over.addEventListener("wheel", wheel, { passive: false });
              let down = 0;
              self.over.addEventListener("mousedown", (e) => (down = e.clientX));
              self.over.addEventListener("mouseup", (e) => {
                const hit = Math.abs(e.clientX - down) < 4 ? closest(self, latest.current.data) : null;
                if (hit) latest.current.onPick?.(...hit);
              });
            },
          ],
        },
      }),
      table,
      box,
    );
    u.setScale("x", { min: latest.current.shown[0], max: latest.current.shown[1] });
    chart.current = u;
    return () => {
      u.destroy();
      chart.current = null;
    };
  }, [formOf(data), height, dark, together, width > 0]);

  useLayoutEffect(() => chart.current?.setSize({ width, height }), [width, height]);
  useLayoutEffect(() => {
    if (chart.current?.data !== table) chart.current?.setData(table, false);
    chart.current?.setScale("x", { min: shown[0], max: shown[1] });
  }, [table, shown[0], shown[1]]);

  const move = (event: KeyboardEvent): void => {
    const [a, b] = shown;
    const width = b - a;
    const to: Record<string, Range | null> = {
      ArrowLeft: [a - width / 5, b - width / 5],
      ArrowRight: [a + width / 5, b + width / 5],
      "+": [a + width / 5, b - width / 5],
      "-": [a - width / 3, b + width / 3],
      "0": null,
    };
    if (!(event.key in to)) return;
    event.preventDefault();
    onRange(to[event.key] ?? null);
  };

  return (
    <figure class="plot">
      <figcaption>
        <b>{data.title}</b>
        <span class="unit">{raised(data.yName + (data.xName ? ` by ${data.xName}` : ""))}</span>
        <span class="legend">
          {data.series.length > 1 &&
            data.series.map((s) => (
              <span key={s.name} class={s.kind}>
                <i style={{ background: strokes(s) }} aria-hidden="true" />
                {s.name}
              </span>
            ))}
        </span>
        <output>{read}</output>
        <SaveMenu
          title={data.title}
          png={() => chart.current && sheetOf(chart.current.ctx.canvas)}
          svg={() => svgOf(data, shown, colour)}
          csv={() => csvOf(data)}
        />
      </figcaption>
      <div
        ref={root}
        tabIndex={0}
        role="img"
        aria-label={`${data.title}, ${data.yName}. Arrow keys move, plus and minus zoom, 0 shows all. Its numbers are in the CSV.`}
        onKeyDown={move}
      />
    </figure>
  );
}

/** What the address holds of a plot's x axis: "0.2~0.9", or "all" where it is not all at first. */
function useZoom(of: string, first: Range | null): [Range | null, (range: Range | null) => void] {
  const name = `zoom-${of}`;
  const [said, [a, b]] = [asked(name), (asked(name) ?? "").split("~").map(Number) as Range];
  useStrange(said !== null && said !== "all" && !(a < b) ? [name] : []);
  const digits = (range: Range): string => range.map((v) => Number(v.toPrecision(6))).join("~");
  return [
    a < b ? [a, b] : said === "all" ? null : first,
    (range) => keep({ [name]: range ? digits(range) : first && "all" }),
  ];
}

/** Where the wheel leads: sideways (or with shift) along, with control nearer or farther; else nowhere. */
function wheeled(u: uPlot, event: WheelEvent): Range | null {
  const { min: a = 0, max: b = 1 } = u.scales["x"] ?? {};
  const along = event.shiftKey ? event.deltaX || event.deltaY : event.deltaX;
  if (!event.ctrlKey && Math.abs(along) <= (event.shiftKey ? 0 : Math.abs(event.deltaY))) return null;
  event.preventDefault();
  const [at, by] = [u.posToVal(event.offsetX, "x"), Math.exp(event.deltaY / 300)];
  if (event.ctrlKey) return [at - (at - a) * by, at + (b - at) * by];
  const step = ((b - a) * along) / u.over.clientWidth;
  return [a + step, b + step];
}

/** Ticks of our own: on logarithmic scales uPlot's search for them does not end for one of fifty ranges (9.5e-9 to 1). */
const ownTicks = (log = false): uPlot.Axis => ({
  splits: (u, axis, low, high) => {
    const room = (axis ? u.bbox.height / 36 : u.bbox.width / 90) / devicePixelRatio;
    return ticksOf([low, high], Math.max(room, 2), log);
  },
  filter: (_u, ticks) => ticks,
  values: (_u, ticks) => ticks.map(onAxis),
});
const digits = (value: number): string => short(value, 5);

/** The line of a series as its legend shows it. */
function strokes({ colour, dash = [] }: Series): string {
  const ends = dash.map((_, i) => dash.slice(0, i + 1).reduce((sum, length) => sum + length, 0));
  const paints = dash.map(
    (_, i) => `${i % 2 ? "transparent" : `var(--${colour})`} ${ends[i - 1] ?? 0}px ${ends[i] ?? 0}px`,
  );
  return dash.length ? `repeating-linear-gradient(90deg, ${paints.join()})` : `var(--${colour})`;
}

const REACH_PX = 14;

/** The point that is nearest to the cursor, if one is within reach. */
function closest(u: uPlot, data: PlotData): [number, number] | null {
  const [left, top] = [u.cursor.left ?? -1, u.cursor.top ?? -1];
  let found: [number, number] | null = null;
  let least = REACH_PX;
  data.series.forEach((s, k) => {
    if (s.kind !== "points") return;
    for (let i = 0; i < s.x.length; i++) {
      const y = s.y[i];
      if (typeof y !== "number") continue;
      const far = Math.hypot(u.valToPos(s.x[i] ?? NaN, "x") - left, u.valToPos(y, "y") - top);
      if (far < least) [found, least] = [[k, i], far];
    }
  });
  return found;
}
