// Which records are there, and how far did each get?
import { useState } from "preact/hooks";
import { useAsset } from "../api/answer";
import { type RecordOut } from "../api/client";
import { may } from "../api/do";
import { Card, Choice, Light, Time, Head } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import { type Column, number, Table } from "../parts/Table";
import { Upload } from "../parts/Upload";
import type { PageProps } from "../shell/place";
import { asked, assetUrl, keep } from "../shell/place";

type Status = RecordOut["status"];
const STATUSES: readonly (readonly [string, string])[] = [
  ["", "All"],
  ["observed", "observed"],
  ["received", "waiting"],
  ["refused", "refused"],
  ["mismatched", "mismatched"],
  ["set_aside", "set aside"],
];

const detail = (record: RecordOut): string => {
  const said = record.problem?.["detail"];
  return typeof said === "string" ? said : record.picks ? "poles picked by hand" : "";
};

const COLUMNS: Column<RecordOut>[] = [
  { title: "Status", show: (r) => <Light status={r.status} />, by: (r) => r.status },
  {
    title: "Began",
    show: (r) => (
      <a href={assetUrl(r.asset, "records", r.record_id)}>
        <Time at={r.start_utc} />
      </a>
    ),
    by: (r) => r.start_utc,
  },
  number("Length", "min", (r) => r.duration_s / 60, { say: (v) => v.toFixed(1) }),
  number("Rate", "Hz", (r) => r.sample_rate_hz, { say: (v) => Number(v.toPrecision(4)) }),
  number("Channels", "", (r) => r.channels.length),
  { title: "Source", show: (r) => r.source_name, by: (r) => r.source_name },
  { title: "Remark", show: (r) => <span class="prose">{detail(r)}</span> },
];
const MORE = 50;

export default function Records({ asset }: PageProps) {
  const status = asked("status") ?? "";
  const [limit, setLimit] = useState(MORE);
  const [from, to] = [asked("from"), asked("to")];
  const query = {
    limit,
    ...(status ? { status: status as Status } : {}),
    ...(from && to ? { from, to } : {}),
  };
  const found = useAsset(asset, "/records", query);
  return (
    <>
      <Head title="Records">
        Ten minutes each; every one is observed once, and its modes go into the state of its day.
      </Head>
      {may("engineer") && <Upload asset={asset} />}
      <div class="tools below">
        <Choice label="Status" kept="status" options={STATUSES} />
      </div>
      <Card
        title={from && to ? `From ${from.slice(0, 10)} to ${to.slice(0, 10)}` : "Latest first"}
        wide
        more={
          from && (
            <button type="button" onClick={() => keep({ from: null, to: null })}>
              All
            </button>
          )
        }
      >
        <Shown of={found} lines={8} none={<Nothing asset={asset} />}>
          {(data) => (
            <>
              <Table label="Records" columns={COLUMNS} rows={data.items} id={(r) => r.record_id} />
              {data.next_cursor && limit < 1000 && (
                <button type="button" onClick={() => setLimit((n) => Math.min(n * 2, 1000))}>
                  Show more
                </button>
              )}
            </>
          )}
        </Shown>
      </Card>
    </>
  );
}

const Nothing = ({ asset }: { asset: string }) => (
  <Empty title="No record of this kind">
    <p>Drop one above, or give a folder on the command line:</p>
    <pre>{`jackettwin intake FOLDER --asset ${asset} --store STORE`}</pre>
  </Empty>
);
