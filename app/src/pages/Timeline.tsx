// How each mode went through time: one graph a mode, one range for all, every point a record.
import { useMemo } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, type Alarm, everything, type Mode, told } from "../api/client";
import { Card, Choice } from "../parts/Bits";
import { byLabel, modeColour } from "../parts/modes";
import { Plot } from "../parts/plot/Plot";
import type { Mark, PlotData, Range } from "../parts/plot/series";
import { Empty, Shown } from "../parts/Shown";
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

export function modePlot(label: string, modes: readonly Mode[], what: string, marks: Mark[]): PlotData {
  const damping = what === "damping";
  const value = (m: Mode): number | null =>
    damping ? m.damping_ratio && 100 * m.damping_ratio : m.frequency_hz;
  const end = (m: Mode, i: 0 | 1): number | null => {
    if (damping) return m.damping_ratio_interval_95 && 100 * (m.damping_ratio_interval_95[i] ?? NaN);
    return m.frequency_std_hz === null ? null : m.frequency_hz + (i ? 1.96 : -1.96) * m.frequency_std_hz;
  };
  return {
    title: words(label),
    time: true,
    xName: "UTC",
    yName: damping ? "damping ratio [%], 95 % intervals" : "frequency [Hz], 95 % intervals",
    log: damping,
    series: [
      {
        name: words(label),
        colour: modeColour(label),
        kind: "points",
        x: modes.map((m) => seconds(m.time_utc)),
        y: modes.map(value),
        low: modes.map((m) => end(m, 0)),
        high: modes.map((m) => end(m, 1)),
      },
    ],
    marks,
  };
}

export const alarmMarks = (alarms: readonly Alarm[]): Mark[] =>
  alarms.map((a) => ({ x: seconds(a.time_utc), words: `alarm ${day(a.time_utc)}`, colour: "alarm" }));

export default function Timeline({ asset }: PageProps) {
  const path = { asset };
  const modes = useAnswer(asset, `modes ${asset}`, () =>
    everything((cursor) =>
      told(
        api.GET("/api/v1/assets/{asset}/modes", {
          params: { path, query: { limit: 10_000, ...(cursor ? { cursor } : {}) } },
        }),
      ),
    ),
  );
  const alarms = useAnswer(asset, `alarms ${asset}`, () =>
    told(api.GET("/api/v1/assets/{asset}/alarms", { params: { path } })),
  );
  const what = asked("show") ?? "frequency";
  const wanted = asked("mode") ?? "";
  const [from, to] = [asked("from"), asked("to")];
  const range: Range | null = from && to ? [seconds(from), seconds(to)] : null;
  return (
    <>
      <div class="head">
        <h1>Modes through time</h1>
        <p>Every point is one record; choose one to open it. Drag to zoom, double-click to see all.</p>
      </div>
      <Shown of={modes} lines={10} empty={(data) => (data.length ? null : <Nothing />)}>
        {(data) => (
          <Drawn
            modes={data}
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
  modes: Mode[];
  marks: Mark[];
  what: string;
  wanted: string;
  range: Range | null;
  open: (mode: Mode) => void;
}

function Drawn({ modes, marks, what, wanted, range, open }: DrawnProps) {
  const groups = useMemo(() => byLabel(modes), [modes]);
  const key = marks.map((m) => m.words).join();
  const plots = useMemo(
    () => [...groups].map(([label, rows]) => ({ label, rows, plot: modePlot(label, rows, what, marks) })),
    [groups, what, key],
  );
  const last = useMemo(() => modes.reduce((t, m) => Math.max(t, seconds(m.time_utc)), 0), [modes]);
  const shown = plots.filter((p) => !wanted || p.label === wanted);
  const show = (days: string): void => keepRange(days ? [last - Number(days) * DAY_S, last + DAY_S] : null);
  const simulated = useMemo(() => modes.filter((m) => m.status === "simulated").length, [modes]);
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
          simulated > 0 && `${simulated} of ${modes.length} points are simulated: nobody measured these days.`
        }
      >
        {shown.map(({ label, rows, plot }) => (
          <Plot
            key={label}
            data={plot}
            height={shown.length === 1 ? 460 : 170}
            range={range}
            onRange={keepRange}
            together="timeline"
            onPick={(_, index) => rows[index] && open(rows[index])}
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
