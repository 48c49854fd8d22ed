// What the ground's parameters do: move one and see every mode follow; how sharply the data decide.
import { useMemo } from "preact/hooks";
import { useAsset } from "../api/answer";
import { type Schemas } from "../api/client";
import { Card, Choice, Head, Pick, Slide, slid } from "../parts/Bits";
import { modeColour, modeDash, paintOf } from "../parts/modes";
import { Plot } from "../parts/plot/Plot";
import type { Mark, PlotData, Series } from "../parts/plot/series";
import { Empty, Shown } from "../parts/Shown";
import { Laws } from "../parts/Laws";
import { extremes, Heat } from "../parts/Heat";
import { number, Table } from "../parts/Table";
import type { PageProps } from "../shell/place";
import { keep, useChosen } from "../shell/place";
import { fixed, frequency, percent, quantity, scientific, short, words } from "../words/numbers";

type Explored = Schemas["ExploredOut"];
type Locus = Schemas["LocusOut"];
type Branch = Schemas["BranchOut"];
type OfBranch = (b: Branch, i: number) => number | null;
const MOST_DAMPED = 0.3;
const lively = (b: Branch, i: number): boolean => (b.damping_ratio[i] ?? 1) < MOST_DAMPED;

const OF = Object.entries({ "": "Frequencies", damping: "Damping ratios" });
type Name = (parameter: string) => string;
type Named = Record<string, Schemas["ExploredValue"]>;
type Grid = Schemas["SurfaceOut"];
/** First and last of some values, in decades. */
const ends = (v: readonly number[]): [number, number] => [Math.log10(v[0] ?? 1), Math.log10(v.at(-1) ?? 10)];

/** Along the parameter: what a branch shows at each of its values, while it swings. */
function along(locus: Locus, name: string, title: string, yName: string, of: OfBranch): PlotData {
  return {
    title,
    xName: `${name} [${locus.unit}]`,
    yName,
    logX: true,
    log: title.startsWith("Damping"),
    series: locus.branches.map((b) => ({
      name: words(b.label),
      colour: modeColour(b.label),
      kind: "line",
      ...modeDash(b.label),
      x: locus.values,
      y: locus.values.map((_, i) => (lively(b, i) ? of(b, i) : null)),
    })),
  };
}

type At = [branch: Branch, index: number];
const dots = (name: string, colour: Series["colour"], at: At[]): Series => ({
  name,
  colour,
  kind: "points",
  x: at.map(([b, i]) => b.pole_real_rad_s[i] ?? 0),
  y: at.map(([b, i]) => b.pole_imag_rad_s[i] ?? null),
});

/** Where the poles go; the point that the slider stands at, in ink. */
function poles(locus: Locus, index: number): PlotData {
  const swings = (b: Branch): At[] => locus.values.flatMap((_, i): At[] => (lively(b, i) ? [[b, i]] : []));
  const series = locus.branches.map((b) => dots(words(b.label), modeColour(b.label), swings(b)));
  const now = locus.branches.filter((b) => lively(b, index)).map((b): At => [b, index]);
  return {
    title: "Root locus",
    xName: "real part [rad/s]",
    yName: "imaginary part of the poles [rad/s]",
    series: [...series, { ...dots("here", "ink", now), names: now.map(([b]) => words(b.label)) }],
  };
}

function Along({ locus, name, many }: { locus: Locus; name: string; many: boolean }) {
  const slider = { name: "at", usual: locus.origin, max: locus.values.length - 1 };
  const index = Math.round(slid(slider));
  const [value, median] = [locus.values[index] ?? 0, locus.values[locus.origin] ?? 1];
  const mark: Mark[] = [{ x: value, words: quantity(value, locus.unit), colour: "ink" }];
  const drawn = useMemo(
    () => [
      along(locus, name, "Frequencies", "frequency over that at the median [%]", (b, i) => {
        const [here, there] = [b.frequency_hz[i], b.frequency_hz[locus.origin]];
        return here && there ? 100 * (here / there) : null;
      }),
      along(locus, name, "Damping ratios", "damping ratio [%]", (b, i) => 100 * (b.damping_ratio[i] ?? NaN) || null),
    ],
    [locus],
  );
  const root = useMemo(() => poles(locus, index), [locus, index]);
  const plots = useMemo(() => drawn.map((plot) => ({ ...plot, marks: mark })), [drawn, value]);
  return (
    <>
      <Card
        title={`Along the ${name}`}
        wide
        note={`${many ? "Every direction's moves by the same factor" : "One parameter moves"}, the others stay where the data put them.`}
      >
        <Slide of={slider}>
          {name} <b>{quantity(value, locus.unit)}</b>
          {index === locus.origin ? " (median)" : ` (${quantity(value / median, "", 3)} × the median)`}
        </Slide>
        <div class="pair">
          {plots.map((plot) => (
            <Plot key={plot.title} data={plot} height={240} together={name} />
          ))}
        </div>
      </Card>
      <Card
        title="Modes here"
        note={`At a ${name} of ${quantity(value, locus.unit)}; at the median as in the report. Damping is that of the sources in the model, without what is unexplained.`}
      >
        <Table
          label="Frequencies and damping ratios"
          rows={locus.branches}
          id={(b) => b.label}
          columns={[
            { title: "Mode", show: (b) => words(b.label) },
            number<Branch>("Frequency", "Hz", (b) => b.frequency_hz[index], { say: (v) => frequency(v) }),
            number<Branch>("Damping ratio", "%", (b) => b.damping_ratio[index], { say: (v) => percent(v) }),
          ]}
        />
      </Card>
      <Card title="Poles" note="Further left is more damped; “here” is where the slider stands.">
        <Plot data={root} height={300} />
      </Card>
    </>
  );
}

function Sensitivity({ asset, said }: { asset: string; said: Name }) {
  const found = useAsset(asset, "/sensitivity");
  const of = useChosen("sensitivity", OF) ? "damping_sensitivity" : "frequency_sensitivity";
  return (
    <Card
      title="Sensitivities"
      wide
      note="Change of each mode, in millionths, if the parameter grows by one per cent: of its frequency by itself, of its damping ratio as it is."
      more={<Choice label="Of" kept="sensitivity" options={OF} />}
    >
      <Shown of={found} none={<Empty title="Not estimated yet" />}>
        {(data) => (
          <Table
            label="Sensitivity of each mode"
            rows={data.items}
            id={(m) => m.label}
            columns={[
              { title: "Mode", show: (m) => words(m.label) },
              ...Object.keys(data.items[0]?.[of] ?? {}).map((name) =>
                number<Schemas["SensitivityOut"]>(said(name), "10⁻⁶", (m) => 1e4 * (m[of][name] ?? NaN), {
                  say: (v) => fixed(v, 1),
                }),
              ),
            ]}
          />
        )}
      </Shown>
    </Card>
  );
}

function Curves({ explored, said }: { explored: Explored; said: Name }) {
  const plot = useMemo(
    (): PlotData => ({
      title: "Cost along each parameter",
      xName: "factor on the median",
      yName: "cost",
      log: true,
      series: (explored.curves ?? []).map(({ parameter: name, factor: x, cost: y }, i) => {
        return { name: said(name), colour: paintOf(i), kind: "line", x, y };
      }),
    }),
    [explored],
  );
  return (
    <Card title="How sharply the data decide" note="A flat curve: the data say little of this parameter.">
      <Plot data={plot} height={300} />
    </Card>
  );
}

function Drawn({ asset, explored }: { asset: string; explored: Explored }) {
  const loci = explored.loci ?? [];
  const names = loci.map((l) => l.parameter);
  const wanted = useChosen("parameter", names);
  const locus = loci.find((l) => l.parameter === wanted);
  const named: Named = Object.fromEntries((explored.parameters ?? []).map((p) => [p.name, p]));
  const many = (l: Locus): string => `${l.words}, every direction`;
  const said: Name = (name) => named[name]?.words ?? loci.filter((l) => l.parameter === name).map(many)[0] ?? name;
  /** Where several move by one factor, values are those of the first. */
  const first = locus && explored.parameters?.find((p) => p.name.startsWith(`${locus.parameter}_`))?.words;
  const own = named[locus?.parameter ?? ""];
  return (
    <>
      <div class="tools">
        <Pick
          label="Parameter"
          value={wanted}
          options={names.map((name) => [name, said(name)] as const)}
          onChoose={(name) => keep({ parameter: name === names[0] ? null : name, at: null })}
        />
        <span class="quiet">Law {explored.law}</span>
      </div>
      <div class="grid">
        {locus && <Along key={locus.parameter} locus={locus} name={own?.words ?? first ?? ""} many={!own} />}
        {explored.surface && (
          <Card
            title="Where the data point"
            note="The cross is where the medians are; a long bright valley means that only a combination is known."
          >
            <Surface surface={explored.surface} named={named} said={said} />
          </Card>
        )}
        <Curves explored={explored} said={said} />
        <Sensitivity asset={asset} said={said} />
      </div>
    </>
  );
}

/** The cost over two parameters, in decades; brighter is nearer to what was measured. */
function Surface({ surface: { x, y, cost }, named, said }: { surface: Grid; named: Named; said: Name }) {
  const cells = useMemo(() => cost.map((row) => row.map((v) => (v ? -Math.log10(v) : null))), [cost]);
  const at = (axis: Grid["x"], v?: number): string => quantity(v, named[axis.parameter]?.unit ?? "");
  const [worst, best] = extremes(cells).map((v) => short(10 ** -v, 2));
  const [ax, ay] = [named[x.parameter]?.value, named[y.parameter]?.value];
  return (
    <Heat
      title="Cost over two parameters"
      unit={`from ${best} (bright) to ${worst} (dark)`}
      cells={cells}
      zName="-log10 of the cost"
      decades
      x={ends(x.values)}
      y={ends(y.values)}
      xName={said(x.parameter)}
      yName={said(y.parameter)}
      sayX={(v) => at(x, 10 ** v)}
      sayY={(v) => at(y, 10 ** v)}
      say={(j, i) =>
        `${said(x.parameter)} ${at(x, x.values[i])}, ${said(y.parameter)} ${at(y, y.values[j])}: cost ${scientific(cost[j]?.[i])}`
      }
      cross={ax && ay ? [Math.log10(ax), Math.log10(ay)] : null}
    />
  );
}

const NOTHING = <Empty title="Nothing to explore yet">This comes with the first estimate of the ground.</Empty>;

export default function Explore({ asset }: PageProps) {
  const found = useAsset(asset, "/explore");
  return (
    <>
      <Head title="Explore">
        What each parameter of the ground does to the modes, and how well the records tell it.
      </Head>
      <Shown of={found} lines={12} some={(data) => data.loci?.length} none={NOTHING}>
        {(data) => <Drawn asset={asset} explored={data} />}
      </Shown>
      <Laws asset={asset} />
    </>
  );
}
