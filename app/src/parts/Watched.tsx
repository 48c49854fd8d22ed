// What conditions leave of each mode, day by day; the evidence for a change; what a planted one would look like.
import { useMemo } from "preact/hooks";
import { useAsset } from "../api/answer";
import type { Schemas } from "../api/client";
import { useChosen } from "../shell/place";
import { NORMAL_90, quantity, words } from "../words/numbers";
import { seconds } from "../words/time";
import { Card, Pick, Slide, slid } from "./Bits";
import { modeColour } from "./modes";
import { Plot } from "./plot/Plot";
import type { Mark, PlotData, Series } from "./plot/series";
import { Empty, Shown } from "./Shown";

export type Watch = Schemas["WatchOut"];
type Smallest = Schemas["SmallestChangeOut"];
const noon = (date: string): number => seconds(`${date}T12:00:00Z`);
const title = (q: Schemas["WatchedQuantity"]): string =>
  words(q.label) + { frequency: "", damping: ", damping", angle: ", direction" }[q.kind];

type Planted = { by: number; from: number; name: string };

/** One quantity after its conditions; with a change planted from a day on. */
export function restPlot(watch: Watch, index: number, marks: Mark[], planted?: Planted): PlotData {
  const q = watch.quantities[index];
  const x = watch.days.map(noon);
  const scale = q?.kind === "angle" ? 180 / Math.PI : 100;
  const scaled = (values: (number | null)[] = [], by = scale): (number | null)[] => values.map((v) => v && by * v);
  const rest = scaled(q?.rest);
  const series: Series[] = [
    {
      name: "90 % if nothing changes",
      colour: "grey",
      kind: "band",
      x,
      y: [],
      low: scaled(q?.rest_std, -NORMAL_90 * scale),
      high: scaled(q?.rest_std, NORMAL_90 * scale),
    },
    { name: "as it was", colour: modeColour(q?.label ?? ""), kind: "points", x, y: rest },
  ];
  if (planted)
    series.push({
      name: planted.name,
      colour: "alarm",
      kind: "points",
      x,
      y: rest.map((v, i) => (v === null || (x[i] ?? 0) < planted.from ? null : v + scale * planted.by)),
    });
  const yName = q?.kind === "angle" ? "unexplained by conditions [°]" : "unexplained by conditions [%]";
  return { title: q ? title(q) : "", yName, series, marks };
}

const NotYet = () => (
  <Empty title="Not watched yet">Days are judged once the baseline is whole, usually after a year.</Empty>
);

type RestsProps = { watch: Watch; marks: Mark[]; kind: string; label: string };

export function Rests({ watch, marks, kind, label }: RestsProps) {
  const key = marks.map((m) => m.words).join();
  const plots = useMemo(
    () =>
      watch.quantities.flatMap((q, i) =>
        q.kind === kind && (!label || q.label === label) ? [restPlot(watch, i, marks)] : [],
      ),
    [watch, kind, label, key],
  );
  if (!plots.length) return <NotYet />;
  return plots.map((plot) => <Plot key={plot.title} data={plot} height={170} together="timeline" />);
}

/** The evidence of each day, and what an alarm would have looked like. */
export default function Evidence({ asset, marks }: { asset: string; marks: Mark[] }) {
  const found = useAsset(asset, "/watch");
  return (
    <Card
      title="Evidence for a change"
      wide
      note="R: how many times more likely the days are if something changed than if nothing did. An alarm is raised where ln R reaches the line, in the mean not more often than promised while nothing changes; then it begins anew."
    >
      <Shown of={found} some={(data) => data.days.length} none={<NotYet />}>
        {(data) => <Drawn watch={data} marks={marks} />}
      </Shown>
    </Card>
  );
}

function Drawn({ watch, marks }: { watch: Watch; marks: Mark[] }) {
  const key = marks.map((m) => m.words).join();
  const plot = useMemo((): PlotData => {
    const x = watch.days.map(noon);
    return {
      title: `Evidence, at most one false alarm in ${watch.arl_years} years`,
      yName: "ln R",
      series: [
        { name: "ln R", colour: "blue", kind: "line", x, y: watch.ln_evidence },
        { name: "alarm", colour: "alarm", kind: "line", dash: [6, 4], x, y: x.map(() => watch.threshold_ln ?? null) },
      ],
      marks,
    };
  }, [watch, key]);
  const possible = watch.smallest.filter((s) => s.step.length && s.size !== null);
  return (
    <>
      <Plot data={plot} height={220} together="evidence" />
      {possible.length > 0 && <WouldBe watch={watch} possible={possible} />}
    </>
  );
}

const said = (s: Smallest): string =>
  `${s.change} of ${s.unit === "m" ? quantity(s.size, "m") : `${(100 * (s.size ?? 0)).toPrecision(2)} %`}: found within ${s.days} days`;

function WouldBe({ watch, possible }: { watch: Watch; possible: Smallest[] }) {
  const options = possible.map((s, i) => [String(i), said(s)] as const);
  const one = possible[Number(useChosen("planted", options))];
  const days = { name: "day", usual: Math.floor(watch.days.length / 10), max: watch.days.length - 1 };
  const at = Math.round(slid(days));
  const from = noon(watch.days[at] ?? "1970-01-01");
  const plots = useMemo(() => {
    const marks: Mark[] = [
      { x: from, words: `planted ${watch.days[at] ?? ""}`, colour: "quiet" },
      { x: from + 86_400 * (one?.days ?? 0), words: "found by now, with 95 %", colour: "alarm" },
    ];
    const steps = watch.quantities.map((_, i) => one?.step[i] ?? 0);
    const clearest = steps
      .map((by, i) => ({ by, i, clear: Math.abs(by) / (watch.quantities[i]?.rest_std.find((v) => v) ?? 1) }))
      .toSorted((a, b) => b.clear - a.clear);
    return clearest
      .slice(0, 3)
      .map(({ by, i }) => restPlot(watch, i, marks, { by, from, name: "if it had changed" }));
  }, [watch, one, from]);
  return (
    <>
      <h3 class="below">What an alarm would have looked like</h3>
      <p class="note">
        The days as they were, and with a planted change added: the smallest that this watch finds with 95 %.
      </p>
      <div class="tools">
        <Pick label="Planted change" bare kept="planted" options={options} />
        <Slide of={days}>planted on {watch.days[at]}</Slide>
      </div>
      {plots.map((plot) => (
        <Plot key={plot.title} data={plot} height={170} together="evidence" />
      ))}
    </>
  );
}
