// The ground's stiffness of each day over that of the first: known then, known by now, and what to expect.
import { useMemo } from "preact/hooks";
import { useAsset } from "../api/answer";
import { type Schemas } from "../api/client";
import { sentence } from "../words/numbers";
import { day, seconds } from "../words/time";
import { Card } from "./Bits";
import { Plot } from "./plot/Plot";
import type { PlotData, Series } from "./plot/series";
import { Empty, Shown } from "./Shown";

type Supports = Schemas["SupportsOut"];
type Median = Schemas["MedianOut"];

const DAY_S = 86_400;
const spans = (x: number[], values: Median[]): Pick<Series, "x" | "y" | "low" | "high"> => ({
  x,
  y: values.map((v) => v.median),
  low: values.map((v) => v.interval_90[0] ?? null),
  high: values.map((v) => v.interval_90[1] ?? null),
});

export function stiffnessPlot(found: Supports): PlotData {
  const then = (found.days ?? [])
    .flatMap((d) => (d.relative_stiffness ? [{ x: seconds(d.time_utc), v: d.relative_stiffness }] : []))
    .reverse();
  const time = found.stiffness_in_time;
  const now = Object.entries(time?.smoothed ?? {}).sort(([a], [b]) => a.localeCompare(b));
  const smoothed = spans(
    now.map(([date]) => seconds(`${date}T12:00:00Z`)),
    now.map(([, v]) => v),
  );
  const last = seconds((found.days ?? [])[0]?.time_utc ?? "1970-01-01T00:00:00Z");
  const later = spans(
    (time?.forecast ?? []).map((f) => last + f.days * DAY_S),
    time?.forecast ?? [],
  );
  return {
    title: "Ground stiffness through time",
    time: true,
    xName: "UTC",
    yName: "over that of the first day",
    series: [
      { name: "90 % by now", colour: "blue", kind: "band", ...smoothed },
      { name: "known by now", colour: "blue", kind: "line", x: smoothed.x, y: smoothed.y },
      { name: "90 % to expect", colour: "grey", kind: "band", ...later },
      { name: "to expect", colour: "grey", kind: "line", dash: [6, 4], x: later.x, y: later.y },
      {
        name: "known on the day",
        colour: "ink",
        kind: "points",
        x: then.map((d) => d.x),
        y: then.map((d) => d.v.median),
      },
    ].filter((s) => s.x.length) as Series[],
    marks: (time?.changes ?? []).map((c) => {
      const by = day(c.time_utc);
      const after = now.findLast(([date]) => date < by)?.[0] ?? by; // the last day known to be as before
      const [x, to] = [after, by].map((date) => seconds(`${date}T12:00:00Z`)) as [number, number];
      return { x, to, words: `change, ${after} to ${by}`, colour: "alarm" };
    }),
  };
}

export default function Stiffness({ asset }: { asset: string }) {
  const found = useAsset(asset, "/supports");
  return (
    <Card title="The ground" wide>
      <Shown
        of={found}
        some={(data) => data.stiffness_in_time}
        none={<Empty title="Not followed yet">The stiffness of each day is followed from the third day on.</Empty>}
      >
        {(data) => <Drawn data={data} />}
      </Shown>
    </Card>
  );
}

function Drawn({ data }: { data: Supports }) {
  const plot = useMemo(() => stiffnessPlot(data), [data]);
  return (
    <>
      {data.statement && <p>{sentence(data.statement)}</p>}
      <Plot data={plot} height={260} />
    </>
  );
}
