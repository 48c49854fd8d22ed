// How the foundation moves: its updated complex modes in phase, and what was measured of each.
import { useMemo } from "preact/hooks";
import { useAnswer, useAsset } from "../api/answer";
import { api, told } from "../api/client";
import { Card, Pick } from "../parts/Bits";
import { InSpace } from "../parts/InSpace";
import { Empty, Shown } from "../parts/Shown";
import type { PageProps } from "../shell/place";
import { asked, useChosen } from "../shell/place";
import { sentence } from "../words/numbers";
import { day, utc } from "../words/time";

function Version({ asset, version }: { asset: string; version: number | undefined }) {
  const query = version === undefined ? {} : { version };
  const found = useAsset(asset, "/structure", query);
  const record = asked("record");
  const moved = useAnswer(null, `motion ${record ?? ""}`, async () => {
    if (!record) return null;
    return told(api.GET("/api/v1/records/{record_id}/motion", { params: { path: { record_id: record } } }));
  });
  const drawn = useMemo(
    () => (found.data && moved.data ? { ...found.data, motions: [moved.data, ...found.data.motions] } : found.data),
    [found.data, moved.data],
  );
  return (
    <Card
      title={version === undefined ? "The adopted version" : `Version ${version}`}
      wide={version === undefined && !asked("beside")}
      note="Every part in its own phase: what is heavily damped does not pass through rest together. Green points are what the sensors measured, in the model's amplitude and phase. Frequencies and damping ratios are the updated ones, as in the report."
    >
      {moved.problem && <p class="error">{sentence(moved.problem.message)}</p>}
      <Shown of={found} lines={12} some={(data) => data.nodes?.length} none={<Nothing />}>
        {(data) => <InSpace drawn={drawn ?? data} />}
      </Shown>
    </Card>
  );
}

export default function Structure({ asset }: PageProps) {
  const versions = useAsset(asset, "/versions");
  const others = versions.data?.items.filter((v) => !v.adopted);
  const records = useAsset(asset, "/records", { limit: 20, status: "observed" });
  const kept = records.data?.items.filter((r) => r.raw_kept) ?? [];
  const moved = kept.map((r): [string, string] => [r.record_id, `the record of ${utc(r.start_utc)} UTC`]);
  const linked = asked("record"); // perhaps an older one
  if (linked && moved.every(([id]) => id !== linked)) moved.push([linked, "the record of the link"]);
  const beside = useChosen("beside", others && ["", ...others.map((v) => String(v.version))]);
  return (
    <>
      <div class="head">
        <h1>Structure</h1>
        {moved.length > 0 && <Pick label="Moved as in" kept="record" options={[["", "its modes"], ...moved]} />}
        {others && others.length > 0 && (
          <Pick
            label="Beside it"
            kept="beside"
            options={[
              ["", "nothing"],
              ...others.map((v) => [String(v.version), `version ${v.version} of ${day(v.created_utc)}`] as const),
            ]}
          />
        )}
      </div>
      <div class="grid">
        <Version asset={asset} version={undefined} />
        {beside && <Version asset={asset} version={Number(beside)} />}
      </div>
    </>
  );
}

const Nothing = () => (
  <Empty title="Nothing to draw yet">
    The structure is drawn with its updated modes, once records have been observed and no record waits.
  </Empty>
);
