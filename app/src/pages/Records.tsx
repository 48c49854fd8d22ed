// Which records are there, and how far did each get?
import { useState } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, type RecordOut, told } from "../api/client";
import { may } from "../api/do";
import { Card, Choice, Light, Time } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import { type Column, Table } from "../parts/Table";
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
  {
    title: "Length",
    unit: "min",
    numeric: true,
    show: (r) => (r.duration_s / 60).toFixed(1),
    by: (r) => r.duration_s,
  },
  {
    title: "Rate",
    unit: "Hz",
    numeric: true,
    show: (r) => Number(r.sample_rate_hz.toPrecision(4)),
    by: (r) => r.sample_rate_hz,
  },
  { title: "Channels", numeric: true, show: (r) => r.channels.length, by: (r) => r.channels.length },
  { title: "Source", show: (r) => r.source_name, by: (r) => r.source_name },
  { title: "Remark", show: (r) => <span class="prose">{detail(r)}</span> },
];
const MORE = 50;

export default function Records({ asset }: PageProps) {
  const status = asked("status") ?? "";
  const [limit, setLimit] = useState(MORE);
  const query = { limit, ...(status ? { status: status as Status } : {}) };
  const found = useAnswer(asset, `records ${asset} ${status} ${limit}`, () =>
    told(api.GET("/api/v1/assets/{asset}/records", { params: { path: { asset }, query } })),
  );
  return (
    <>
      <div class="head">
        <h1>Records</h1>
        <p>Ten minutes each; every one is observed once, and its modes go into the state of its day.</p>
      </div>
      {may("engineer") && <Upload asset={asset} />}
      <div class="tools below">
        <Choice
          label="Status"
          value={status}
          options={STATUSES}
          onChoose={(s) => keep({ status: s || null })}
        />
      </div>
      <Card title="Latest first" wide>
        <Shown of={found} lines={8} empty={(data) => (data.items.length ? null : <Nothing asset={asset} />)}>
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
