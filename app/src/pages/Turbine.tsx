// One screen: what the foundation does now, what changed and why, and how sure that is.
import { Suspense } from "preact/compat";
import { useAsset } from "../api/answer";
import type { Alarm, Asset, Schemas } from "../api/client";
import { AlarmList } from "../parts/AlarmList";
import { Assumptions } from "../parts/Assumptions";
import { Ago, Card, Light } from "../parts/Bits";
import { Budget, budgetCsv } from "../parts/Budget";
import { Empty, Shown, Trouble } from "../parts/Shown";
import { ModeTable } from "../parts/ModeTable";
import { Table } from "../parts/Table";
import { later } from "../parts/later";
import { SaveDrawn } from "../parts/plot/SaveMenu";
import type { PageProps } from "../shell/place";
import { assetUrl } from "../shell/place";
import { between, count, frequency, percent, quantity, recordsOf, sentence, words, years, yearsTo } from "../words/numbers"; // prettier-ignore

const Stiffness = later(() => import("../parts/Stiffness"));
type Twin = Schemas["TwinOut"];
type Knowledge = Schemas["Knowledge"];
const RECORDS = [{ title: "Records", numeric: true, show: (m: Schemas["TwinMode"]) => m.records }];

/** Numbers that a manager asks for: first bending modes, ground, alarms, life; each leads to its page. */
function Figures({ own, twin, alarms }: { own: Asset; twin: Twin; alarms: readonly Alarm[] }) {
  if (!twin.records) return null;
  const { recent_modes: modes, parameters: known } = twin;
  const first = modes.filter((m) => m.label === "fore_aft_1" || m.label === "side_side_1");
  const ground = Object.values(known.parameters).find((p) => p.unit === "N/m");
  const open = alarms.filter((a) => !a.acknowledged_by && !a.closed_by && !a.muted_until_utc).length;
  const figures: [string, string, string, string][] = first.map((m) => [
    words(m.label),
    `${frequency(m.frequency_hz)} Hz`,
    `damping ${percent(m.damping_ratio, m.damping_ratio_std)} % (90 %), mean of 30 days`,
    `timeline?mode=${m.label}`,
  ]);
  if (ground) {
    const [low, high] = ground.interval_90 ?? [];
    const interval = low && high ? `${between(low, high, ground.unit)} (90 %)` : "no interval";
    const value = quantity(ground.median, ground.unit);
    figures.push([`${ground.words}, ${of(ground)}`, value, interval, "timeline?show=ground"]);
  }
  figures.push(["open alarms", String(open), `${count(alarms.length, "alarm")} in all`, "alarms"]);
  if (own.remaining_years !== null) {
    const interval = `${yearsTo(own.remaining_years_interval_90)} (90 %), of the first weld`;
    figures.push(["life left", `${years(own.remaining_years)} years`, interval, "life"]);
  }
  figures.push(["known from", count(twin.records, "record"), `of ${count(twin.days, "day")}`, "records"]);
  return (
    <dl class="figures">
      {figures.map(([name, value, more, page]) => (
        <div key={name}>
          <dt>{name}</dt>
          <dd>
            <a href={`${assetUrl(own.name)}/${page}`}>{value}</a>
            <small>{more}</small>
          </dd>
        </div>
      ))}
    </dl>
  );
}

/** The records of an estimate: where the twin file names states of operation, those in them. */
const restsOn = (known?: Knowledge): string => `Of the ${recordsOf(known)} that the estimate rests on`;

/** What an estimate is of: ground that changes is told as on its newest day. */
const of = (p: Schemas["KnownParameter"]): string => p.day ?? "all records";

const Supports = ({ known }: { known: Knowledge["parameters"] }) => (
  <Table
    label="Supports"
    rows={Object.entries(known)}
    id={([name]) => name}
    columns={[
      { title: "Parameter", show: ([, p]) => <span class="prose">{p.words}</span> },
      { title: "Median and 90 % interval", show: ([, p]) => <span class="prose">{p.text}</span> },
      { title: "Of", show: ([, p]) => of(p) },
    ]}
  />
);

/** The answer, and its numbers, which are folded where the page is narrow. */
const Said = ({ sentences: [first, ...others] }: { sentences: string[] }) => (
  <>
    <strong>{first}</strong>
    {others.length > 0 && (
      <details class="others">
        <summary>{count(others.length, "more sentence")}</summary>
        {others.map((one) => (
          <p key={one}>{one}</p>
        ))}
      </details>
    )}
  </>
);

/** The report's first page in short, where a reader begins. */
function Answers({ asset, known }: { asset: string; known: Knowledge }) {
  return (
    <Card
      title="What is known, and what to do"
      wide
      more={<a href={assetUrl(asset, "reports")}>Report</a>}
      note={`${restsOn(known)}; in brackets 90 % intervals. What changes with time is told above and below.`}
    >
      <dl class="answers">
        {known.answers.map(({ question, answer }) => (
          <div key={question}>
            <dt>{question}</dt>
            <dd>
              <Said sentences={answer.split(/(?<=\.) (?=[A-Z])/)} />
            </dd>
          </div>
        ))}
      </dl>
    </Card>
  );
}

function Head({ asset, twin }: { asset: Asset; twin: Twin | undefined }) {
  const left = ["refused", "mismatched", "set_aside"].reduce((n, s) => n + (asset.records[s] ?? 0), 0);
  const waiting = (asset.records["received"] ?? 0) + (asset.records["observing"] ?? 0);
  return (
    <div class="head">
      <Light status={asset.status} long />
      <h1>{asset.name}</h1>
      <span class="quiet">
        {asset.last_record_utc ? "last data " : "no data yet"}
        {asset.last_record_utc && <Ago at={asset.last_record_utc} />}
        {waiting ? `, ${count(waiting, "record")} waiting` : ""}
        {left ? `, ${count(left, "record")} left out` : ""}
        {` · model version ${asset.version}`}
      </span>
      {asset.comment && <p>{asset.comment}</p>}
      {twin && twin.status !== "ok" && <p class="said">{sentence(twin.status)}</p>}
    </div>
  );
}

export function Turbine({ asset }: PageProps) {
  const own = useAsset(asset, "");
  const twin = useAsset(asset, "/twin");
  const alarms = useAsset(asset, "/alarms");
  if (own.data === undefined && own.problem) return <Trouble title={asset} problem={own.problem} again={own.again} />;
  const known = twin.data?.parameters;
  const [parameters, budget] = [known?.parameters ?? {}, known?.budget ?? []];
  return (
    <>
      {own.data ? <Head asset={own.data} twin={twin.data} /> : <h1 class="head">{asset}</h1>}
      {own.data && twin.data && <Figures own={own.data} twin={twin.data} alarms={alarms.data?.items ?? []} />}
      <div class="grid">
        <Card title="What changed, and why" more={<a href={assetUrl(asset, "alarms")}>All alarms</a>}>
          <Shown of={alarms} none={<Unchanged />} lines={3}>
            {(data) => <AlarmList alarms={mostUrgent(data.items).slice(0, 3)} again={alarms.again} />}
          </Shown>
        </Card>
        <Card
          title="What it does now"
          more={<a href={assetUrl(asset, "timeline")}>Through time</a>}
          note="Means of the 30 days up to the last record, whatever the rotor did."
        >
          <Shown of={twin} some={(data) => data.records} none={<NoRecord asset={asset} />} lines={7}>
            {(data) => <ModeTable asset={asset} modes={data.recent_modes} more={RECORDS} />}
          </Shown>
        </Card>
        {known?.answers.length ? <Answers asset={asset} known={known} /> : null}
        <Suspense fallback={null}>
          <Stiffness asset={asset} />
        </Suspense>
        <Card
          title="Damping by source"
          note={`Damping ratio in %. ${restsOn(known)}.`}
          more={budget.length > 0 && <SaveDrawn title="Damping by source" csv={() => budgetCsv(budget)} />}
        >
          <Shown of={twin} some={() => budget.length} none={<NotYet />} lines={7}>
            {() => <Budget asset={asset} modes={budget} />}
          </Shown>
        </Card>
        <Card
          title="Ground and rotor"
          note={known?.law && `Law ${known.law}, ${known.status}. ${restsOn(known)}.`}
          more={<a href={assetUrl(asset, "reports")}>Report</a>}
        >
          <Shown of={twin} some={() => known?.law} none={<NotYet />} lines={5}>
            {() => <Supports known={parameters} />}
          </Shown>
        </Card>
        <Assumptions asset={asset} known={parameters} />
      </div>
    </>
  );
}

/** What is open before what is closed, newest first. */
const mostUrgent = (alarms: readonly Alarm[]): Alarm[] =>
  alarms.toSorted((a, b) => Number(Boolean(a.closed_by)) - Number(Boolean(b.closed_by)));

const Unchanged = () => <Empty title="No change was found">Changes are watched for once a baseline is whole.</Empty>;

const NoRecord = ({ asset }: { asset: string }) => (
  <Empty title="No record has been observed">
    <p>Give the first one on the command line, or on the page of records:</p>
    <pre>{`jackettwin intake RECORD --asset ${asset} --store STORE`}</pre>
  </Empty>
);

const NotYet = () => <Empty title="Not estimated yet">This is done when no record waits, and takes a minute.</Empty>;
