// Which turbine needs me?
import { useAnswer } from "../api/answer";
import { api, type Asset, told } from "../api/client";
import { Ago, Choice, Find, Head, Light, Press } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import { type Column, number, Table } from "../parts/Table";
import { asked, assetUrl, keep, useChosen } from "../shell/place";
import { SaveDrawn } from "../parts/plot/SaveMenu";
import { mapCsv, Site } from "../parts/Site";
import { count, sentence, yearsWithin } from "../words/numbers";

const URGENT = ["alarm", "warning", "no data", "ok"];
const some = (asset: Asset, ...statuses: string[]): number =>
  statuses.reduce((sum, status) => sum + (asset.records[status] ?? 0), 0);

const COLUMNS: Column<Asset>[] = [
  {
    title: "Status",
    show: (a) => <Light status={a.status} />,
    by: (a) => URGENT.indexOf(a.status) - Math.min(a.open_alarms, 999) / 1000,
  },
  { title: "Turbine", show: (a) => <a href={assetUrl(a.name)}>{a.name}</a>, by: (a) => a.name },
  {
    title: "Why",
    show: (a) =>
      a.reason && (
        <a class="prose" href={assetUrl(a.name, a.open_alarms ? "alarms" : "records")}>
          {sentence(a.reason)}
        </a>
      ),
  },
  number("Open", "alarms", (a) => a.open_alarms),
  {
    title: "Last data",
    show: (a) => (a.last_record_utc ? <Ago at={a.last_record_utc} /> : "none yet"),
    by: (a) => a.last_record_utc,
  },
  number("Life left", "years, 90 %", (a) => a.remaining_years, {
    say: (left, a) => yearsWithin(left, a.remaining_years_interval_90),
  }),
  number("Records", "observed", (a) => some(a, "observed")),
  number("Waiting", "records", (a) => some(a, "received", "observing")),
];

const Nothing = () => (
  <Empty title="No turbine yet">
    <p>
      <a href="/start">Add one</a> with its files, or on the command line:
    </p>
    <pre>jackettwin asset add NAME TWIN --store STORE{"\n"}jackettwin intake RECORDS --asset NAME --store STORE</pre>
  </Empty>
);

/** "2 turbines need you" */
export function headline(assets: readonly Asset[]): string {
  const alarms = assets.filter((a) => a.status === "alarm").length;
  const warnings = assets.filter((a) => a.status === "warning").length;
  if (alarms) return `${count(alarms, "turbine")} with an alarm that nobody has acknowledged.`;
  if (warnings) return `${count(warnings, "turbine")} with records that were left out; no open alarm.`;
  return "No open alarm.";
}

export function Fleet() {
  const assets = useAnswer("", "assets", () => told(api.GET("/api/v1/assets")));
  const [wanted, text] = [useChosen("status", ["", ...URGENT]), (asked("find") ?? "").toLowerCase()];
  const fits = (a: Asset): boolean => (!wanted || a.status === wanted) && a.name.toLowerCase().includes(text);
  return (
    <>
      <Head title="Turbines" said>
        {assets.data?.items.length ? headline(assets.data.items) : ""}
      </Head>
      <Shown of={assets} none={<Nothing />} lines={6}>
        {(data) => {
          const rows = data.items.filter(fits);
          return (
            <section class="card" aria-label="All turbines">
              {data.items.length > 1 && <Site assets={data.items} />}
              {data.items.length > 1 && <SaveDrawn title="Map" csv={() => mapCsv(data.items)} />}
              <div class="tools">
                <Choice label="Status" kept="status" options={[["", `All ${data.items.length}`], ...URGENT]} />
                <Find label="Find a turbine" />
              </div>
              {rows.length ? (
                <Table label="Turbines" columns={COLUMNS} rows={rows} id={(a) => a.name} sorted="Status" most={100} />
              ) : (
                <Empty title="No turbine fits">
                  <Press words="Show all" act={() => keep({ status: null, find: null })} />
                </Empty>
              )}
            </section>
          );
        }}
      </Shown>
    </>
  );
}
