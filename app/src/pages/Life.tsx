// What life is left: the welds that records damage most, and how sure that is.
import { useAsset } from "../api/answer";
import { type Schemas } from "../api/client";
import { Card, Facts, Head, Light } from "../parts/Bits";
import { SaveDrawn } from "../parts/plot/SaveMenu";
import { csvFrom } from "../parts/plot/series";
import { Empty, Shown } from "../parts/Shown";
import { type Column, number, Table } from "../parts/Table";
import type { PageProps } from "../shell/place";
import { assetUrl, linkWith, useChosen } from "../shell/place";
import { count, fixed, scientific, years, yearsWithin } from "../words/numbers";
import { day } from "../words/time";

type Weld = Schemas["LifeOut"];
/** Where each row is a card, some are enough at first. */
const PHONE = matchMedia("(max-width: 600px)");
const YEAR_S = 365.25 * 86_400;

const key = (w: Weld): string => `${w.joint} ${w.brace} ${w.side}`;
/** A weld around a tube is named by what it joins. */
const named = (w: Weld): string => (w.side === "tube" ? `${w.joint}, ` : `${w.joint} – ${w.brace}, `) + w.side;
const state = (w: Weld): string => {
  if (w.departed) return "alarm";
  if (w.beyond_validity.length) return "doubtful";
  return w.over_budget ? "alarm" : w.rate_per_year > w.budget_per_year ? "warning" : "ok";
};
const largest = (shares: Record<string, number>): string[] =>
  Object.entries(shares)
    .toSorted(([, a], [, b]) => b - a)
    .filter(([, share]) => share >= 0.005)
    .map(([name, share]) => `${Math.round(100 * share)} % ${name}`);

const COLUMNS: Column<Weld>[] = [
  { title: "Status", show: (w) => <Light status={state(w)} />, by: state },
  { title: "Weld", show: (w) => <a href={linkWith({ weld: key(w) })}>{named(w)}</a>, by: key },
  number("Above the sea", "m", (w) => w.above_sea_m, { say: (v) => fixed(v, 1) }),
  number("Left", "years, 90 %", (w) => w.remaining_years.p50 ?? Infinity, {
    say: (left, { remaining_years: { p05, p95 } }) => yearsWithin(left, [p05, p95]),
  }),
  number("Damage a year", "times what is allowed", (w) => w.rate_per_year / w.budget_per_year, {
    say: (v) => scientific(v, 2),
  }),
  number("Fails in a year", "probability", (w) => w.failure_probability_per_year, { say: (v) => scientific(v, 2) }),
];

const points = ({ damage_by_point: found }: Weld): [number, number][] =>
  found.map((damage, i) => [(360 * i) / found.length, damage]);

/** The eight points around a weld, from its crown on; the worst is the one that counts. */
function Around({ weld }: { weld: Weld }) {
  const most = Math.max(...weld.damage_by_point, 1e-300);
  return (
    <svg class="around drawn" viewBox="-72 -64 144 128" role="img" aria-label={`Damage around ${named(weld)}`}>
      <circle r="50" />
      <circle r="25" />
      {["0°", "90°", "180°", "270°"].map((words, i) => (
        <text key={words} x={[0, 61, 0, -61][i]} y={[-54, 2.5, 60, 2.5][i]}>
          {words}
        </text>
      ))}
      {points(weld).map(([angle, damage]) => {
        const [r, turn] = [(50 * damage) / most, (angle * Math.PI) / 180];
        const [x, y] = [r * Math.sin(turn), -r * Math.cos(turn)];
        return (
          <g key={angle}>
            <line x2={x} y2={y} />
            <path d={`M${x - 3} ${y}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0`}>
              <title>{`${angle}°: ${scientific(damage, 2)}`}</title>
            </path>
          </g>
        );
      })}
    </svg>
  );
}

function One({ weld }: { weld: Weld }) {
  const [low, high] = weld.damage_interval_90;
  const facts: [string, string | string[]][] = [
    ["Worst point", weld.position],
    ["Environment", weld.environment],
    ["Damage so far", `${scientific(weld.damage, 2)} (90 %: ${scientific(low, 2)} to ${scientific(high, 2)})`],
    ["It rests on", `${count(weld.records, "record")}, ${span(weld.observed_s)}`],
    ["Life by the design curve", `${years(weld.life_years)} years, of which ${years(weld.age_years)} are gone`],
    ["What leaves it open", largest(weld.variance_shares)],
    ["By state of operation", largest(weld.damage_by_state)],
    ["Beyond the range of its factors", weld.beyond_validity],
    ["Over its budget since", day(weld.over_budget?.since ?? "")],
    ["Departed from its past since", day(weld.departed?.since ?? "")],
  ];
  return (
    <div class="weld">
      <Around weld={weld} />
      <Facts facts={facts.filter(([, said]) => said.length)} />
    </div>
  );
}

export default function Life({ asset }: PageProps) {
  const life = useAsset(asset, "/life");
  const wanted = useChosen("weld", life.data?.items.map(key));
  return (
    <>
      <Head title="Life" said>
        {life.data && headline(life.data.items)}
      </Head>
      <Shown of={life} lines={8} none={<Nothing />}>
        {(data) => {
          const weld = data.items.find((w) => key(w) === wanted);
          return (
            <div class="grid">
              <Card
                title="Welds, the shortest life first"
                wide
                more={<a href={assetUrl(asset, "structure") + COLOURED}>In space</a>}
                note="As if the years were like the records; the interval is what records, curves and factors leave open."
              >
                <Table
                  label="Welds"
                  columns={COLUMNS}
                  rows={data.items}
                  id={key}
                  mark={(w) => (w === weld ? "here" : "")}
                  most={PHONE.matches ? 5 : Infinity}
                />
              </Card>
              {weld && (
                <Card
                  title={named(weld)}
                  wide
                  more={
                    <SaveDrawn title={named(weld)} csv={() => csvFrom([["degrees", "damage"], ...points(weld)])} />
                  }
                  note={`Damage at eight points around the weld; at the rim ${scientific(Math.max(...weld.damage_by_point), 2)}, the worst.`}
                >
                  <One weld={weld} />
                </Card>
              )}
            </div>
          );
        }}
      </Shown>
    </>
  );
}

/** The structure coloured by its welds' lives. */
const COLOURED = `?quantity=${encodeURIComponent("life left, worst weld [years]")}`;

/** How long records are, in words. */
const span = (s: number): string =>
  s < 7200
    ? `${Math.round(s / 60)} minutes`
    : s < 2 * 86_400
      ? `${Math.round(s / 3600)} hours`
      : `${Math.round(s / 86_400)} days`;

function headline(welds: readonly Weld[]): string {
  const [worst, beyond] = [welds[0], welds.filter((w) => w.beyond_validity.length).length];
  if (!worst) return "";
  const over = welds.filter((w) => w.over_budget).length;
  const { p05, p50, p95 } = worst.remaining_years;
  return [
    over ? `${count(over, "weld")} beyond what a year is allowed.` : "",
    `The first weld has ${years(p50)} years left (${years(p05)} to ${years(p95)}).`,
    worst.observed_s < YEAR_S / 4 ? `It rests on little: ${span(worst.observed_s)} of records.` : "",
    beyond
      ? `Of ${count(beyond, "weld")} beyond the range of the factors nothing is certain: they are listed last.`
      : "",
  ].join(" ");
}

const Nothing = () => (
  <Empty title="No life yet">
    <p>
      Life is counted from records, weld by weld, once the twin file says <code>life: {"{}"}</code> and the server has
      the extra package <code>fatigue</code>.
    </p>
    <pre>pip install 'jackettwin[service,fatigue]'</pre>
  </Empty>
);
