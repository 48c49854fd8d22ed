// The report on all records, to read, print and send; tables to take away.
import { useAsset } from "../api/answer";
import { Card } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import type { PageProps } from "../shell/place";
import { recordsOf } from "../words/numbers";

const EXPORT = "/api/v1/export.parquet?table=";
const TABLES = ["modes", "findings", "records", "states", "conditions"];

export default function Reports({ asset }: PageProps) {
  const twin = useAsset(asset, "/twin");
  return (
    <>
      <div class="head">
        <h1>Report</h1>
        <div class="end">
          {TABLES.map((table) => (
            <a key={table} class="button" download={`${table}.parquet`} href={EXPORT + table}>
              {table} (Parquet)
            </a>
          ))}
        </div>
      </div>
      <Shown of={twin} lines={10} some={(data) => data.parameters.reported} none={<Nothing />}>
        {(data) => {
          const known = data.parameters;
          const url = `/assets/${encodeURIComponent(asset)}/report?version=${data.version}`;
          return (
            <Card
              title={`Of ${recordsOf(known)}`}
              wide
              more={
                <a href={url} target="_blank" rel="noreferrer">
                  On a page of its own
                </a>
              }
            >
              <iframe
                class="report"
                title={`Report on ${asset}`}
                src={url}
                key={`${known.until_utc} ${known.records}`}
              />
            </Card>
          );
        }}
      </Shown>
    </>
  );
}

const Nothing = () => (
  <Empty title="No report yet">
    It is written when no record waits, in a minute or two: <a href="/jobs">what is being done</a>.
  </Empty>
);
