// How each mode went through time: one graph a mode, one range for all, every point a record.
import { useEffect, useMemo, useState } from "preact/hooks";
import { useAnswer, useAsset } from "../api/answer";
import { api, everything, type Mode, told } from "../api/client";
import { Card, Choice, Head, Pick } from "../parts/Bits";
import { alarmMarks, binPlot, type Bins, byLabel, modePlot } from "../parts/modes";
import type { PlotData } from "../parts/plot/series";
import { Empty, Shown, Trouble } from "../parts/Shown";
import { stamp } from "../parts/plot/series";
import { Plot } from "../parts/plot/Plot";
import Stiffness from "../parts/Stiffness";
import { Rests } from "../parts/Watched";
import type { PageProps } from "../shell/place";
import { assetUrl, go, keepStretch, stretch, useChosen } from "../shell/place";
import { words } from "../words/numbers";
import { seconds } from "../words/time";

const LEFT = { left: "Frequency residual", "damping-left": "Damping residual" };
const QUANTITIES = Object.entries({ frequency: "Frequency", damping: "Damping", ...LEFT, ground: "Ground" });
const STATES = Object.entries({ "": "Any state", parked: "parked", idling: "idling", operating: "operating" });
const SPANS = Object.entries({ 30: "30 days", 90: "90 days", 365: "1 year", "": "All" });
const DAY_S = 86_400;
const REST_MS = 150;
/** Of so many rows each is drawn. */
const ROWS = 8000;
const POINTS = 1000;

/** Bins, and every row, unless there are too many. */
type Seen = { bins: Bins[]; rows: Mode[] | null };

/** What is known of some modes, or all, in a stretch of time. */
async function look(
  asset: string,
  times: { from?: string; to?: string; state?: string },
  labels: string[] = [],
): Promise<Seen> {
  const path = { asset };
  const one = (label: object): Promise<{ items: Bins[] }> => {
    const query = { ...times, ...label, points: POINTS };
    return told(api.GET("/api/v1/assets/{asset}/modes/bins", { params: { path, query } }));
  };
  const asks = labels.length ? labels.map((label) => one({ label })) : [one({})];
  const found = (await Promise.all(asks)).flatMap((page) => page.items).filter((b) => b.label);
  const first = (b: Bins): number => b.frequency_hz.median[0] ?? 0;
  const bins = found.sort((a, b) => first(a) - first(b));
  if (countOf(bins) > ROWS) return { bins, rows: null };
  const page = (cursor: string | undefined): Promise<{ items: Mode[]; next_cursor?: string | null }> => {
    const query = { limit: 10_000, ...times, ...(cursor ? { cursor } : {}) };
    return told(api.GET("/api/v1/assets/{asset}/modes", { params: { path, query } }));
  };
  return { bins, rows: await everything(page) };
}

const countOf = (bins: readonly Bins[]): number => bins.reduce((n, b) => b.count.reduce((sum, k) => sum + k, n), 0);

export default function Timeline({ asset }: PageProps) {
  const state = useChosen("state", STATES);
  const of = state ? { state } : {};
  const all = useAnswer(asset, `modes ${asset} ${state}`, () => look(asset, of));
  const assets = useAnswer(null, "assets", () => told(api.GET("/api/v1/assets")));
  const others = assets.data?.items.map((a) => a.name).filter((name) => name !== asset);
  const other = useChosen("beside", others && ["", ...others]);
  const beside = useAnswer(null, `beside ${other} ${state}`, async () => (other ? (await look(other, of)).bins : []));
  const what = useChosen("show", QUANTITIES);
  const [ground, raw] = [what === "ground", what === "frequency" || what === "damping"];
  const [from, to] = stretch.value?.map(stamp) ?? [];
  const labels = all.data?.bins.map((b) => b.label) ?? [];
  // What is drawn row by row as a whole needs no closer look.
  const close = useRested(from && to && labels.length && !all.data?.rows ? `${from} ${to}` : "");
  const part = useAnswer(
    asset,
    `part of ${asset} ${state} ${close && "close"}`,
    async () => {
      const [from = "", to = ""] = close.split(" ");
      return close ? look(asset, { from, to, ...of }, labels) : null;
    },
    close,
  );
  return (
    <>
      <Head title={ground ? "The ground through time" : "Modes through time"}>
        {raw && "Every point is one record; choose one to open it. "}Drag to zoom, double-click to see all.
      </Head>
      {close && part.problem && <Trouble problem={part.problem} again={part.again} />}
      <div class="tools">
        <Choice label="Quantity" kept="show" options={QUANTITIES} />
        {raw && <Choice label="State" kept="state" options={STATES} />}
        {raw && others && others.length > 0 && (
          <Pick label="Beside" kept="beside" options={[["", "no other turbine"], ...others]} />
        )}
        {from && to && (
          <a href={`${assetUrl(asset, "records")}?${String(new URLSearchParams({ from, to }))}`}>
            Records of this stretch
          </a>
        )}
      </div>
      <Shown of={all} lines={10} some={(data) => data.bins.length} none={<Nothing />}>
        {(data) => (
          <Drawn
            all={data.bins}
            seen={(close && part.data) || data}
            what={what}
            beside={{ name: other, bins: beside.data ?? [] }}
            asset={asset}
          />
        )}
      </Shown>
    </>
  );
}

/** A value once it has stood still: while a reader moves, what is there is moved. */
function useRested(value: string): string {
  const [rested, setRested] = useState(value);
  useEffect(() => {
    const timer = setTimeout(() => setRested(value), REST_MS);
    return () => clearTimeout(timer);
  }, [value]);
  return rested;
}

interface DrawnProps {
  all: Bins[];
  seen: Seen;
  what: string;
  beside: { name: string; bins: Bins[] };
  asset: string;
}

type Drawing = { label: string; plot: PlotData; pick: (index: number) => void };

function Drawn({ all, seen, what, beside, asset }: DrawnProps) {
  const watch = useAsset(asset, "/watch").data;
  const marks = alarmMarks(useAsset(asset, "/alarms").data?.items);
  const wanted = useChosen("mode", ["", ...all.map((b) => b.label)]);
  const range = stretch.value;
  const key = marks.map((m) => m.words).join();
  const plots = useMemo((): Drawing[] => {
    const groups = seen.rows && byLabel(seen.rows);
    return all.map((whole) => {
      const label = whole.label;
      if (groups) {
        const rows = groups.get(label) ?? [];
        const pick = (index: number): void => {
          if (rows[index]) go(assetUrl(asset, "records", rows[index].record_id));
        };
        const plot = withOther(modePlot(label, rows, what, marks), beside, label, what);
        return { label, plot, pick };
      }
      const bins = seen.bins.find((b) => b.label === label) ?? { ...whole, time_s: [] };
      const pick = (index: number): void => {
        const from = seconds(bins.start_utc) + (bins.time_s[index] ?? 0);
        keepStretch([Math.floor(from), Math.ceil(from + bins.bin_s)]);
      };
      return { label, plot: withOther(binPlot(bins, what, marks), beside, label, what), pick };
    });
  }, [all, seen, what, key, beside.name, beside.bins]);
  const last = Math.max(...all.map((b) => seconds(b.start_utc) + (b.time_s.at(-1) ?? 0) + b.bin_s));
  const first = Math.min(...all.map((b) => seconds(b.start_utc) + (b.time_s[0] ?? 0)));
  const shown = plots.filter((p) => !wanted || p.label === wanted);
  const show = (days: string): void => keepStretch(days ? [last - Number(days) * DAY_S, last + DAY_S] : null);
  const kind = what === "left" ? "frequency" : "damping";
  const simulated = all.reduce((n, b) => n + b.simulated, 0);
  const span = range ? String(Math.round((range[1] - range[0]) / DAY_S - 1)) : "";
  return (
    <>
      <div class="tools">
        <Choice label="Range" value={span} options={SPANS} onChoose={show} />
        {what !== "ground" && (
          <Pick
            label="Mode"
            kept="mode"
            options={[["", `all ${plots.length}`], ...plots.map((p) => [p.label, words(p.label)] as const)]}
          />
        )}
      </div>
      {what === "ground" && <Stiffness asset={asset} />}
      {what.endsWith("left") && (
        <Card
          title={`Residuals of ${kind}`}
          wide
          note="Daily means without what wind, sea, temperature and tide explain."
        >
          {watch && <Rests watch={watch} marks={marks} kind={kind} label={wanted} />}
        </Card>
      )}
      {(what === "frequency" || what === "damping") && (
        <Card
          title={what === "damping" ? "Damping ratios" : "Frequencies"}
          wide
          note={`${simulated > 0 ? `${simulated} of ${countOf(all)} points are simulated: nobody measured these days. ` : ""}Triangles lie beyond the scale, and are known much less than most.`}
        >
          {!seen.rows && <p class="quiet">Bins of time; choose one, or zoom, to see its records.</p>}
          {shown.map(({ label, plot, pick }) => (
            <Plot
              key={label}
              data={plot}
              height={shown.length === 1 ? 460 : 170}
              together="timeline"
              first={[first, last]}
              onPick={(_, index) => pick(index)}
            />
          ))}
        </Card>
      )}
    </>
  );
}

/** A mode's plot with the medians of another turbine's mode of the same name. */
function withOther(plot: PlotData, other: DrawnProps["beside"], label: string, what: string): PlotData {
  const bins = other.bins.find((b) => b.label === label);
  if (!bins) return plot;
  const [median] = binPlot(bins, what, []).series.slice(-1);
  return median ? { ...plot, series: [...plot.series, { ...median, name: other.name, colour: "grey" }] } : plot;
}

const Nothing = () => (
  <Empty title="No mode yet">
    Modes are found in records: give one on the page of records, or wait until those that arrived are observed.
  </Empty>
);
