// Poles of every model order; they are picked by click or from the list, kept, and taken back.
import { useEffect, useMemo, useState } from "preact/hooks";
import { useRecord } from "../api/answer";
import { api, type Mode, type RecordOut, type Schemas, told } from "../api/client";
import { may, useDeed } from "../api/do";
import { keep, useChosen } from "../shell/place";
import { fixed, frequency, percent, words } from "../words/numbers";
import { Card, Press, Time } from "./Bits";
import { Plot } from "./plot/Plot";
import type { PlotData, Series } from "./plot/series";
import { Shown } from "./Shown";

type Poles = Schemas["StabilisationOut"];
type Pick_ = { frequency_hz: number; order: number };
const keyOf = ({ frequency_hz, order }: Pick_): string => `${order} ${frequency_hz}`;
const poleOf = (poles: Poles, i: number): Pick_ => ({
  frequency_hz: poles.frequency_hz[i] ?? NaN,
  order: poles.order[i] ?? 0,
});

const KIND = ["picked", "stable", "not stable"] as const;
const PAINT = { picked: "alarm", stable: "green", "not stable": "grey" } as const;

/** The numbers of the poles that are shown as the k-th kind, from the lowest frequency on. */
function shownAs(k: number, poles: Poles, taken: Set<string>): number[] {
  const kindOf = (i: number): number => (taken.has(keyOf(poleOf(poles, i))) ? 0 : poles.stable[i] ? 1 : 2);
  const { frequency_hz: f } = poles;
  return [...f.keys()].filter((i) => kindOf(i) === k).sort((a, b) => (f[a] ?? 0) - (f[b] ?? 0));
}

type ChartProps = { poles: Poles; picks: Pick_[]; onPick: (pole: Pick_) => void; modes: readonly Mode[] };

function Chart({ poles, picks, onPick, modes }: ChartProps) {
  const groups = useMemo(() => {
    const taken = new Set(picks.map(keyOf));
    return KIND.map((_, k) => shownAs(k, poles, taken));
  }, [poles, picks]);
  const plot = useMemo((): PlotData => {
    const series = KIND.map((kind, k): Series => {
      const own = groups[k] ?? [];
      const at = (values: number[]): number[] => own.map((i) => values[i] ?? NaN);
      const [x, y] = [at(poles.frequency_hz), at(poles.order)];
      const said = own.map((i) => `damping ${percent(poles.damping_ratio[i])} %, MPC ${fixed(poles.mpc[i], 2)}`);
      return { name: kind, colour: PAINT[kind], kind: "points", x, y, said };
    });
    const marks = modes.map((m) => ({ x: m.frequency_hz, words: words(m.label), colour: "quiet" }));
    const names = { title: "Stabilisation chart", xName: "frequency [Hz]", yName: "model order" };
    return { ...names, series, marks };
  }, [groups, modes]);
  const chosen = (series: number, index: number): void => {
    const pole = groups[series]?.[index];
    if (pole !== undefined) onPick(poleOf(poles, pole));
  };
  return <Plot data={plot} height={340} onPick={chosen} />;
}

/** Of every mode that poles were gathered to, the stable pole of highest order: what the keyboard picks from. */
export function candidates(poles: Poles): number[] {
  const best = new Map<number, number>();
  poles.mode.forEach((mode, i) => {
    const old = best.get(mode);
    if (mode >= 0 && poles.stable[i] && (old === undefined || (poles.order[i] ?? 0) >= (poles.order[old] ?? 0)))
      best.set(mode, i);
  });
  return [...best.values()].sort((a, b) => (poles.frequency_hz[a] ?? 0) - (poles.frequency_hz[b] ?? 0));
}

const kept = ({ picks }: RecordOut): Pick_[] => (picks?.["poles"] ?? []) as Pick_[];

type OfRecord = { record: RecordOut; modes: readonly Mode[]; again: () => void };

export function Stabilisation(of: OfRecord) {
  const open = useChosen("poles", ["", "shown"]);
  return (
    <Card
      title="Poles"
      wide
      note="Poles of every model order; MPC is 1 where all sensors move in phase or antiphase. Choose some to take them instead of the automatic choice; the record is identified again."
    >
      {open ? (
        <Open {...of} />
      ) : (
        <Press words="Compute the stabilisation chart" act={() => keep({ poles: "shown" })} />
      )}
    </Card>
  );
}

function Open({ record, modes, again }: OfRecord) {
  const [picks, setPicks] = useState(kept(record));
  useEffect(() => setPicks(kept(record)), [JSON.stringify(record.picks)]);
  const deed = useDeed();
  const path = { params: { path: { record_id: record.record_id } } };
  const poles = useRecord(record.record_id, "/stabilisation");
  const taken = new Set(picks.map(keyOf));
  const switched = (pole: Pick_): void => {
    if (!may("engineer")) return;
    setPicks(taken.has(keyOf(pole)) ? picks.filter((p) => keyOf(p) !== keyOf(pole)) : [...picks, pole]);
  };
  const save = async (chosen: Pick_[]): Promise<void> => {
    const done = await deed.run(() =>
      told(api.PUT("/api/v1/records/{record_id}/picks", { ...path, body: { picks: chosen } })),
    );
    if (done) again();
  };
  return (
    <Shown of={poles} lines={9}>
      {(data) => (
        <>
          <Chart poles={data} picks={picks} onPick={switched} modes={modes} />
          {may("engineer") && (
            <>
              <div class="tools" role="group" aria-label="Poles to take">
                {candidates(data).map((i) => (
                  <label key={i}>
                    <input
                      type="checkbox"
                      checked={taken.has(keyOf(poleOf(data, i)))}
                      onChange={() => switched(poleOf(data, i))}
                    />{" "}
                    {frequency(data.frequency_hz[i])} Hz, {percent(data.damping_ratio[i])} %, MPC{" "}
                    {fixed(data.mpc[i], 2)}
                  </label>
                ))}
              </div>
              <div class="tools">
                <Press
                  words={`Take ${picks.length} picked`}
                  look="main"
                  off={deed.busy || !picks.length}
                  act={() => save(picks)}
                />
                <Press words="Return to the automatic choice" off={deed.busy || !record.picks} act={() => save([])} />
                {deed.problem && <span class="error">{deed.problem.message}</span>}
              </div>
            </>
          )}
          {record.picks && (
            <p class="quiet">
              Picked by {String(record.picks["by"])}, <Time at={String(record.picks["time_utc"])} />.
            </p>
          )}
        </>
      )}
    </Shown>
  );
}
