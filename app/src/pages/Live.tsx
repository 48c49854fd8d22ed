// What happens now: signals roll as they arrive, or as they did in the newest record, and the structure moves.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { type View } from "../../../src/jackettwin/report/templates/view.js";
import { useAsset, useRecord } from "../api/answer";
import { hear } from "../api/events";
import { api, type RecordOut, type Schemas, told } from "../api/client";
import { Card, Head, Time, Pick } from "../parts/Bits";
import { InSpace } from "../parts/InSpace";
import { SaveDrawn } from "../parts/plot/SaveMenu";
import { Lanes, Roll } from "../parts/Roll";
import { Empty, Shown } from "../parts/Shown";
import { type PageProps, useChosen } from "../shell/place";
import { raised } from "../words/numbers";
import { seconds } from "../words/time";

const SPANS_S = ["10", "30", "120"];
const SPAN_S = 30;
const PIECE_S = 60;
type Packet = { channel: string; t0_utc: string; rate_hz: number; samples: (number | null)[] };

/** Packets as they arrive; true once one did. */
function useStream(asset: string, roll: Roll): boolean {
  const [streams, setStreams] = useState(false);
  useEffect(
    () =>
      hear(`/api/v1/assets/${encodeURIComponent(asset)}/live`, ["packet"], (said) => {
        const { channel, t0_utc, rate_hz, samples } = said as Packet;
        if (!roll.streams) roll.begin(seconds(t0_utc), true); // a packet behind, so that it rolls while the next comes
        roll.add(channel, seconds(t0_utc), 1 / rate_hz, samples);
        setStreams(true);
      }),
    [asset, roll],
  );
  return streams;
}

/** The newest record from its start on, again and again, while nothing arrives. */
function useReplay(record: RecordOut | undefined, roll: Roll): void {
  useEffect(() => {
    if (!record) return;
    roll.units = Object.fromEntries(record.channels.map((c) => [String(c["name"]), raised(String(c["unit"]))]));
    roll.begin(SPAN_S, false); // a full picture from the first moment on
    let asked = 0;
    const more = async (): Promise<void> => {
      if (roll.streams || roll.now() < asked - PIECE_S / 2) return;
      const from = asked % record.duration_s;
      const base = asked - from;
      const to = Math.min(from + PIECE_S, record.duration_s);
      asked = base + to;
      const query = { from, to, points: 10_000 };
      const params = { path: { record_id: record.record_id }, query };
      const found = (await told(api.GET("/api/v1/records/{record_id}/signal", { params }))) as Schemas["Signal"];
      if (roll.streams) return;
      const step = (found.time_s[1] ?? 1) - (found.time_s[0] ?? 0);
      for (const [name, bins] of Object.entries(found.channels)) roll.add(name, base + from, step, bins["max"] ?? []);
    };
    const again = (): void => void more().catch(() => undefined);
    again();
    const timer = setInterval(again, 1000);
    return () => clearInterval(timer);
  }, [record?.record_id, roll]);
}

function Moving({ drawn, record, roll }: { drawn: Schemas["StructureOut"]; record: RecordOut; roll: Roll }) {
  const view = useRef<View | null>(null);
  const asked = useRecord(record.record_id, "/motion", { duration_s: 600 });
  const motion = asked.data;
  useEffect(() => {
    const timer = setInterval(() => {
      const start = motion?.start_s ?? 0;
      view.current?.stand((((roll.now() - start) % record.duration_s) + record.duration_s) % record.duration_s);
    }, 40);
    return () => clearInterval(timer);
  }, [motion]);
  const moved = useMemo(() => ({ ...drawn, motions: motion ? [motion] : [] }), [drawn, motion]);
  return (
    <>
      {!motion && (
        <p class="note">{asked.problem?.message ?? "Its motion is computed by a worker once one is free."}</p>
      )}
      <InSpace drawn={moved} view={view} />
    </>
  );
}

export default function Live({ asset }: PageProps) {
  const [roll] = useState(() => new Roll());
  const span = Number(useChosen("span", SPANS_S, String(SPAN_S)));
  const streams = useStream(asset, roll);
  const listed = useAsset(asset, "/records", { limit: 100, status: "observed" });
  const record = listed.data?.items.find((r) => r.raw_kept);
  useReplay(record, roll);
  const structure = useAsset(asset, "/structure");
  return (
    <>
      <Head title="Live">
        {streams ? "Samples as they arrive from the broker." : "Nothing streams in"}
        {!streams && record && (
          <>
            : the record of <Time at={record.start_utc} /> is played again, at its own pace
          </>
        )}
        {!streams && "."}
      </Head>
      <Shown of={listed} some={() => record || streams} none={<Nothing />}>
        {() => (
          <div class="grid">
            <Card
              title="Signals"
              wide={!record || streams || !structure.data?.nodes.length}
              more={
                <>
                  <SaveDrawn title="Signals" csv={() => roll.csv(span)} />{" "}
                  <Pick
                    label="Shown"
                    bare
                    kept="span"
                    usual={String(SPAN_S)}
                    options={SPANS_S.map((s) => [s, `last ${s} s`] as const)}
                  />
                </>
              }
            >
              <Lanes roll={roll} span={span} />
            </Card>
            {record && !streams && structure.data?.nodes.length ? (
              <Card
                title="Structure"
                note="Displacements between 0.1 and 1.5 Hz by the modes that the sensors tell apart."
              >
                <Moving drawn={structure.data} record={record} roll={roll} />
              </Card>
            ) : null}
          </div>
        )}
      </Shown>
    </>
  );
}

const Nothing = () => (
  <Empty title="Nothing to show yet">
    Samples are shown as a broker sends them (`--mqtt`), or as the newest record has them.
  </Empty>
);
