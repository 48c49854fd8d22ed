// How each mode went through time: one graph a mode, one range for all, every point a record.
import { useMemo } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, type Alarm, everything, type Mode, told } from "../api/client";
import { Card, Choice } from "../parts/Bits";
import { binPlot, type Bins, byLabel, modePlot } from "../parts/modes";
import { Plot } from "../parts/plot/Plot";
import type { Mark, PlotData, Range } from "../parts/plot/series";
import { Empty, Shown, Trouble } from "../parts/Shown";
import { keepRange } from "../parts/Stiffness";
import type { PageProps } from "../shell/place";
import { asked, assetUrl, go, keep } from "../shell/place";
import { words } from "../words/numbers";
import { day, seconds } from "../words/time";

const QUANTITIES = [
  ["frequency", "Frequency"],
  ["damping", "Damping"],
] as const;
const SPANS = [
  ["30", "30 days"],
  ["90", "90 days"],
  ["365", "1 year"],
  ["", "All"],
] as const;
const DAY_S = 86_400;
/** Of so many rows each is drawn. */
const ROWS = 20_000;
const POINTS = 1000;

interface Seen {
  bins: Bins[];
  /** Every row, unless there are too many. */
  rows: Mode[] | null;
}

/** What is known of some modes, or all, in a stretch of time. */
async function look(
  asset: string,
  times: { from?: string; to?: string },
  labels: string[] = [],
): Promise<Seen> {
  const path = { asset };
  const one = (label: object): Promise<{ items: Bins[] }> =>
    told(
      api.GET("/api/v1/assets/{asset}/modes/bins", {
        params: { path, query: { ...times, ...label, points: POINTS } },
      }),
    );
  const asks = labels.length ? labels.map((label) => one({ label })) : [one({})];
  const found = (await Promise.all(asks)).flatMap((page) => page.items).filter((b) => b.label);
  const first = (b: Bins): number => b.frequency_hz.median[0] ?? 0;
  const bins = found.sort((a, b) => first(a) - first(b));
  if (countOf(bins) > ROWS) return { bins, rows: null };
  const page = (cursor: string | undefined): Promise<{ items: Mode[]; next_cursor?: string | null }> =>
    told(
      api.GET("/api/v1/assets/{asset}/modes", {
        params: { path, query: { limit: 10_000, ...times, ...(cursor ? { cursor } : {}) } },
      }),
    );
  return { bins, rows: await everything(page) };
}

const countOf = (bins: readonly Bins[]): number =>
  bins.reduce((n, b) => b.count.reduce((sum, k) => sum + k, n), 0);

const alarmMarks = (alarms: readonly Alarm[]): Mark[] =>
  alarms.map((a) => ({ x: seconds(a.time_utc), words: `alarm ${day(a.time_utc)}`, colour: "alarm" }));

export default function Timeline({ asset }: PageProps) {
  const path = { asset };
  const all = useAnswer(asset, `modes ${asset}`, () => look(asset, {}));
  const alarms = useAnswer(asset, `alarms ${asset}`, () =>
    told(api.GET("/api/v1/assets/{asset}/alarms", { params: { path } })),
  );
  const what = asked("show") ?? "frequency";
  const wanted = asked("mode") ?? "";
  const [from, to] = [asked("from"), asked("to")];
  const range: Range | null = from && to ? [seconds(from), seconds(to)] : null;
  const labels = all.data?.bins.map((b) => b.label) ?? [];
  // What is drawn row by row as a whole needs no closer look.
  const close = from && to && labels.length && !all.data?.rows ? { from, to } : null;
  const part = useAnswer(
    asset,
    `modes ${asset} ${JSON.stringify(close)}`,
    async () => close && look(asset, close, labels),
  );
  return (
    <>
      <div class="head">
        <h1>Modes through time</h1>
        <p>Every point is one record; choose one to open it. Drag to zoom, double-click to see all.</p>
      </div>
      {close && part.problem && <Trouble problem={part.problem} again={part.again} />}
      <Shown of={all} lines={10} empty={(data) => (data.bins.length ? null : <Nothing />)}>
        {(data) => (
          <Drawn
            all={data.bins}
            seen={(close && part.data) || data}
            marks={alarmMarks(alarms.data?.items ?? [])}
            what={what}
            wanted={wanted}
            range={range}
            open={(m) => go(assetUrl(asset, "records", m.record_id))}
          />
        )}
      </Shown>
    </>
  );
}

interface DrawnProps {
  all: Bins[];
  seen: Seen;
  marks: Mark[];
  what: string;
  wanted: string;
  range: Range | null;
  open: (mode: Mode) => void;
}

interface Drawing {
  label: string;
  plot: PlotData;
  pick: (index: number) => void;
}

function Drawn({ all, seen, marks, what, wanted, range, open }: DrawnProps) {
  const key = marks.map((m) => m.words).join();
  const plots = useMemo((): Drawing[] => {
    const groups = seen.rows && byLabel(seen.rows);
    return all.map((whole) => {
      const label = whole.label;
      if (groups) {
        const rows = groups.get(label) ?? [];
        const pick = (index: number): void => {
          if (rows[index]) open(rows[index]);
        };
        return { label, plot: modePlot(label, rows, what, marks), pick };
      }
      const bins = seen.bins.find((b) => b.label === label) ?? { ...whole, time_s: [] };
      const pick = (index: number): void => {
        const from = seconds(bins.start_utc) + (bins.time_s[index] ?? 0);
        keepRange([Math.floor(from), Math.ceil(from + bins.bin_s)]);
      };
      return { label, plot: binPlot(bins, what, marks), pick };
    });
  }, [all, seen, what, key]);
  const last = Math.max(...all.map((b) => seconds(b.start_utc) + (b.time_s.at(-1) ?? 0) + b.bin_s));
  const shown = plots.filter((p) => !wanted || p.label === wanted);
  const show = (days: string): void => keepRange(days ? [last - Number(days) * DAY_S, last + DAY_S] : null);
  const simulated = all.reduce((n, b) => n + b.simulated, 0);
  const span = range ? String(Math.round((range[1] - range[0]) / DAY_S - 1)) : "";
  return (
    <>
      <div class="tools">
        <Choice
          label="Quantity"
          value={what}
          options={QUANTITIES}
          onChoose={(show) => keep({ show: show === "frequency" ? null : show })}
        />
        <Choice label="Range" value={span} options={SPANS} onChoose={show} />
        <label>
          Mode{" "}
          <select value={wanted} onChange={(event) => keep({ mode: event.currentTarget.value || null })}>
            <option value="">all {plots.length}</option>
            {plots.map((p) => (
              <option key={p.label} value={p.label}>
                {words(p.label)}
              </option>
            ))}
          </select>
        </label>
      </div>
      <Card
        title={what === "damping" ? "Damping ratios" : "Frequencies"}
        wide
        note={
          simulated > 0 && `${simulated} of ${countOf(all)} points are simulated: nobody measured these days.`
        }
      >
        {!seen.rows && <p class="quiet">Bins of time; choose one, or zoom, to see its records.</p>}
        {shown.map(({ label, plot, pick }) => (
          <Plot
            key={label}
            data={plot}
            height={shown.length === 1 ? 460 : 170}
            range={range}
            onRange={keepRange}
            together="timeline"
            onPick={(_, index) => pick(index)}
          />
        ))}
      </Card>
    </>
  );
}

const Nothing = () => (
  <Empty title="No mode yet">
    <p>
      Modes are found in records: give one on the page of records, or wait until those that arrived are
      observed.
    </p>
  </Empty>
);
