// What one record holds: signals at any zoom, spectrum, stabilisation chart, and poles picked by hand.
import { useEffect, useMemo, useState } from "preact/hooks";
import { type Answer, useAnswer, useAsset, useRecord } from "../api/answer";
import { api, type Mode, type RecordOut, type Schemas, told } from "../api/client";
import { Card, Choice, Facts, Light, Time, Pick } from "../parts/Bits";
import { extremes, Heat } from "../parts/Heat";
import { paintOf } from "../parts/modes";
import { Plot } from "../parts/plot/Plot";
import type { Mark, PlotData } from "../parts/plot/series";
import { Shown } from "../parts/Shown";
import { Stabilisation } from "../parts/Stabilisation";
import { ModeTable } from "../parts/ModeTable";
import type { PageProps } from "../shell/place";
import { asked, keep, stretch, useChosen, useStrange } from "../shell/place";
import { fixed, sentence, short, words } from "../words/numbers";
import { seconds } from "../words/time";

const POINTS = 1400;
const SPECTRA = Object.entries({ "": "Channels", singular: "Singular values" });
type Stretch = Schemas["StretchOut"];
const UNITS: Record<string, string> = { m_s: "m/s", deg: "°", c: "°C", rpm: "1/min", m: "m", s: "s" };

/** mean_wind_speed_m_s: mean wind speed [m/s]. */
export function condition(name: string): string {
  const [, own = name, unit = ""] = /^(.*?)_(m_s|deg|c|rpm|m|s)$/.exec(name) ?? [];
  return own.replaceAll("_", " ") + (unit && ` [${UNITS[unit]}]`);
}

/** The signals, with what was said of their faults. */
function Signals({ record, onDrawn }: { record: RecordOut; onDrawn: () => void }) {
  const names = record.channels.map((c) => String(c["name"]));
  const wanted = asked("channels")?.split("\n") ?? names.slice(0, 3);
  const chosen = names.filter((name) => wanted.includes(name));
  useStrange(wanted.some((name) => name && !names.includes(name)) ? ["channels"] : []);
  const begin = seconds(record.start_utc);
  const range = stretch.value;
  const query = {
    channels: chosen,
    points: POINTS,
    ...(range ? { from: Math.max(range[0] - begin, 0), to: Math.max(range[1] - begin, 0.1) } : {}),
  };
  const signal = useRecord(record.record_id, "/signal", query) as Answer<Schemas["Signal"]>;
  const there = Boolean(signal.data ?? signal.problem);
  useEffect(() => void (there && onDrawn()), [there]);
  const stretches = useRecord(record.record_id, "/stretches");
  const faults = stretches.data?.items ?? [];
  const switched = (name: string): void =>
    keep({ channels: names.filter((n) => (n === name) !== chosen.includes(n)).join("\n") });
  const plots = useMemo(
    () =>
      Object.entries(signal.data?.channels ?? {}).map(([name, bins]): PlotData => {
        const unit = record.channels.find((c) => c["name"] === name)?.["unit"];
        const colour = paintOf(names.indexOf(name));
        const x = (signal.data?.time_s ?? []).map((t) => begin + t);
        const [low, high] = [bins["min"] ?? [], bins["max"] ?? []];
        return {
          title: name,
          yName: typeof unit === "string" ? unit : "",
          series: [{ name, colour, kind: "band", solid: true, x, y: [], low, high }],
          marks: faults.filter((f) => (f.channel ?? name) === name).map((f) => mark(f, begin)),
        };
      }),
    [signal.data, stretches.data],
  );
  return (
    <Card
      title="Signals"
      wide
      note="Least and greatest value of each bin, as many bins as the plot is wide. Drag to zoom, double-click to see all."
    >
      <div class="tools" role="group" aria-label="Channels">
        {names.map((name) => (
          <label key={name}>
            <input type="checkbox" checked={chosen.includes(name)} onChange={() => switched(name)} /> {name}
          </label>
        ))}
      </div>
      {chosen.length === 0 ? (
        <p class="quiet">Choose a channel.</p>
      ) : (
        <Shown of={signal} lines={8}>
          {() => plots.map((plot) => <Plot key={plot.title} data={plot} height={120} together="signal" />)}
        </Shown>
      )}
      {faults.length > 0 && (
        <ul class="list">
          {[...new Set(faults.map((f) => `${f.channel ?? "All channels"}: ${f.text}`))].map((text) => (
            <li key={text}>{text}</li>
          ))}
        </ul>
      )}
    </Card>
  );
}

const mark = (f: Stretch, begin: number): Mark => ({
  x: begin + f.from_s,
  ...(f.to_s > f.from_s ? { to: begin + f.to_s } : {}),
  words: f.code.replaceAll("_", " "),
  colour: "alarm",
});

function Spectrum({ record, modes }: { record: RecordOut; modes: readonly Mode[] }) {
  const what = useChosen("spectrum", SPECTRA);
  const found = useRecord(record.record_id, "/spectrum");
  const key = modes.map((m) => m.frequency_hz).join();
  const plot = useMemo((): PlotData | null => {
    if (!found.data) return null;
    const { frequency_hz, channels, units, singular_values } = found.data;
    const first = Object.values(units)[0] ?? "";
    const rows: [string, number[]][] = what
      ? singular_values.map((row, i) => [["largest", "second", "third"][i] ?? `${i + 1}.`, row])
      : Object.entries(channels).filter(([name]) => units[name] === first);
    const series = rows.map(([name, y], i) => ({
      name,
      colour: paintOf(i),
      kind: "line" as const,
      x: frequency_hz.slice(1),
      y: y.slice(1).map((v) => (v > 0 ? v : null)),
    }));
    const marks: Mark[] = modes.map((m) => ({ x: m.frequency_hz, words: words(m.label), colour: "quiet" }));
    const title = what ? "Singular values" : "Spectrum";
    return { title, xName: "frequency [Hz]", yName: first, log: true, series, marks };
  }, [found.data, key, what]);
  return (
    <Card
      title="Spectral densities"
      wide
      note="Welch's method, segments of a minute; upright lines are the modes found. A peak of the largest singular value alone is one mode, of two at once a close pair."
      more={<Choice label="What" kept="spectrum" options={SPECTRA} />}
    >
      <Shown of={found} lines={6}>
        {() => plot && <Plot data={plot} height={300} first={[0, Math.min(2, record.sample_rate_hz / 2)]} />}
      </Shown>
    </Card>
  );
}

function Spectrogram({ record }: { record: RecordOut }) {
  const names = record.channels.map((c) => String(c["name"]));
  const channel = useChosen("channel", names);
  const found = useRecord(record.record_id, "/spectrogram", { channel });
  const cells = useMemo(() => {
    const rows = found.data?.level_db ?? [];
    return (found.data?.frequency_hz ?? []).map((_, k) => rows.map((row) => row[k] ?? null));
  }, [found.data]);
  const [least, most] = extremes(cells);
  return (
    <Card
      title="Spectrogram"
      wide
      note="Segments of a minute that overlap by three quarters; a mode is a level line, what moves with the rotor is not."
      more={<Pick label="Channel" bare kept="channel" options={names} />}
    >
      <Shown of={found} lines={6}>
        {({ time_s, frequency_hz, segment_s, unit, level_db }) => (
          <Heat
            title={channel}
            unit={`from ${fixed(least, 0)} (dark) to ${fixed(most, 0)} (bright) dB of ${unit}`}
            cells={cells}
            zName={`level [dB of ${unit}]`}
            x={[(time_s[0] ?? 0) / 60, ((time_s.at(-1) ?? 0) + segment_s) / 60]}
            y={[0, frequency_hz.at(-1) ?? 1]}
            xName="minutes after its start"
            yName="frequency [Hz]"
            sayX={String}
            sayY={String}
            say={(j, i) =>
              `${((time_s[i] ?? 0) / 60).toFixed(1)} min, ${(frequency_hz[j] ?? 0).toFixed(3)} Hz: ${fixed(level_db[i]?.[j], 1)} dB`
            }
          />
        )}
      </Shown>
    </Card>
  );
}

const about = (record: RecordOut): [string, string][] => [
  ["Length", `${record.duration_s.toFixed(0)} s at ${Number(record.sample_rate_hz.toPrecision(4))} Hz`],
  ["Source", record.source_name],
  ...Object.entries(record.conditions).map(([name, value]): [string, string] => [
    condition(name),
    typeof value === "number" ? short(value, 6) : String(value),
  ]),
];

const STATUS = [{ title: "Status", show: (m: Mode) => <Light status={m.status} /> }];

export default function Record({ asset, id }: PageProps) {
  const record = useAnswer(asset, `record ${id}`, () =>
    told(api.GET("/api/v1/records/{record_id}", { params: { path: { record_id: id } } })),
  );
  const modes = useAsset(asset, "/modes", { record: id, limit: 100 });
  const found = modes.data?.items ?? [];
  const [drawn, setDrawn] = useState(false);
  if (record.data === undefined) return <Shown of={record} title="Record" children={() => null} />;
  const data = record.data;
  const problem = data.problem?.["detail"];
  return (
    <>
      <div class="head">
        <Light status={data.status} />
        <h1>
          Record of <Time at={data.start_utc} />
        </h1>
        {typeof problem === "string" && <p class="said">{problem}</p>}
      </div>
      <div class="grid">
        <Card title="Modes found">
          <Shown of={modes} none={<p class="quiet">None yet.</p>}>
            {({ items }) => (
              <>
                <ModeTable asset={asset} modes={items} more={STATUS} />
                {items.map((m) => m.reason && <p class="note">{sentence(`${m.label || "unnamed"}: ${m.reason}`)}</p>)}
              </>
            )}
          </Shown>
        </Card>
        <Card title="What it is">
          <Facts facts={about(data)} />
        </Card>
        {data.raw_kept ? (
          <>
            <Signals record={data} onDrawn={() => setDrawn(true)} />
            {drawn && <Spectrum record={data} modes={found} />}
            {drawn && <Spectrogram record={data} />}
            <Stabilisation record={data} modes={found} again={record.again} />
          </>
        ) : (
          <p class="quiet">
            {data.conditions["simulated"]
              ? "There are no samples: nobody measured this day."
              : "Its samples are not kept any more."}
          </p>
        )}
      </div>
    </>
  );
}
