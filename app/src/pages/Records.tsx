// Which records are there, and how far did each get?
import { useAsset } from "../api/answer";
import type { Mode, RecordOut } from "../api/client";
import { may } from "../api/do";
import { Card, Choice, Head, Light, Press, Time } from "../parts/Bits";
import { ModeTable } from "../parts/ModeTable";
import { Empty, Shown } from "../parts/Shown";
import { type Column, number, Table } from "../parts/Table";
import { Upload } from "../parts/Upload";
import type { PageProps } from "../shell/place";
import { assetUrl, keep, numberAsked, stretch, useChosen } from "../shell/place";
import { stamp } from "../parts/plot/series";
import { NORMAL_90, percent } from "../words/numbers";

type Status = RecordOut["status"];
const LEFT_OUT = { refused: "refused", mismatched: "mismatched", set_aside: "set aside" };
const STATUSES = Object.entries({ "": "All", observed: "observed", received: "waiting", ...LEFT_OUT });

const detail = (record: RecordOut): string => {
  const said = record.problem?.["detail"];
  return typeof said === "string" ? said : record.picks ? "poles picked by hand" : "";
};

const Began = ({ asset, id, at }: { asset: string; id: string; at: string }) => (
  <a href={assetUrl(asset, "records", id)}>
    <Time at={at} />
  </a>
);

const COLUMNS: Column<RecordOut>[] = [
  { title: "Status", show: (r) => <Light status={r.status} />, by: (r) => r.status },
  {
    title: "Began",
    show: (r) => <Began asset={r.asset} id={r.record_id} at={r.start_utc} />,
    by: (r) => r.start_utc,
  },
  number("Length", "min", (r) => r.duration_s / 60, { say: (v) => v.toFixed(1) }),
  number("Rate", "Hz", (r) => r.sample_rate_hz, { say: (v) => Number(v.toPrecision(4)) }),
  number("Channels", "", (r) => r.channels.length),
  { title: "Source", show: (r) => r.source_name, by: (r) => r.source_name },
  { title: "Remark", show: (r) => <span class="prose">{detail(r)}</span> },
];
const [MORE, MOST] = [20, 1000];

export default function Records({ asset }: PageProps) {
  const status = useChosen("status", STATUSES);
  const limit = numberAsked("rows", 1, MOST) ?? MORE;
  const [from, to] = stretch.value?.map(stamp) ?? [];
  const times = from && to ? { from, to } : {};
  const query = { limit, ...(status ? { status: status as Status } : {}), ...times };
  const found = useAsset(asset, "/records", query);
  return (
    <>
      <Head title="Records">Every record is observed once, and its modes go into the state of its day.</Head>
      {may("engineer") && <Upload asset={asset} />}
      <div class="tools below">
        <Choice label="Status" kept="status" options={STATUSES} />
      </div>
      <LeastKnown asset={asset} times={times} />
      <Card
        title={from && to ? `From ${from.slice(0, 10)} to ${to.slice(0, 10)}` : "Latest first"}
        wide
        more={from && <Press words="All" act={() => keep({ from: null, to: null })} />}
      >
        <Shown of={found} lines={8} none={<Nothing asset={asset} />}>
          {(data) => (
            <>
              <Table label="Records" columns={COLUMNS} rows={data.items} id={(r) => r.record_id} />
              {data.next_cursor && limit < MOST && (
                <Press words="Show more" act={() => keep({ rows: String(Math.min(limit * 2, MOST)) })} />
              )}
            </>
          )}
        </Shown>
      </Card>
    </>
  );
}

const SHOWN = 5;
const vagueness = ({ frequency_hz: f, frequency_std_hz: std }: Mode): string =>
  std === null ? "–" : `± ${percent((NORMAL_90 * std) / f, null, 1)}`;

/** Which record is worst, and why. */
function LeastKnown({ asset, times }: { asset: string; times: object }) {
  const found = useAsset(asset, "/modes", { ...times, order: "least_known", limit: 10 * SHOWN });
  const modes = found.data?.items ?? [];
  const rows = modes.filter((m, i) => modes.findIndex((o) => o.record_id === m.record_id) === i).slice(0, SHOWN);
  const vague = { title: "Uncertain by", unit: "% of it, 90 %", numeric: true, show: vagueness };
  const began = { title: "Record", show: (m: Mode) => <Began asset={asset} id={m.record_id} at={m.time_utc} /> };
  return (
    <Card
      title="The worst first"
      wide
      note="Records whose frequencies are least certain for their size, each with its widest mode: a mode is known the less, the more it is damped and the fewer of its cycles the record holds."
    >
      <Shown of={found} lines={5} none={<p class="quiet">No mode yet.</p>}>
        {() => <ModeTable asset={asset} modes={rows} id={(m) => m.record_id} first={[began]} more={[vague]} />}
      </Shown>
    </Card>
  );
}

const Nothing = ({ asset }: { asset: string }) => (
  <Empty title="No record of this kind">
    <p>Drop one above, or give a folder on the command line:</p>
    <pre>{`jackettwin intake FOLDER --asset ${asset} --store STORE`}</pre>
  </Empty>
);
