// A support law by slider: what it stores and loses at each frequency, and how it creeps.
import { useMemo } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { quantity } from "../words/numbers";
import { useChosen } from "../shell/place";
import { Card, Choice, Slide, slid } from "./Bits";
import { Plot } from "./plot/Plot";
import type { PlotData, Series } from "./plot/series";
import { Shown } from "./Shown";

/** Of each parameter: name, unit, least, greatest and first value, in decades where it spans some. */
type Parameter = readonly [string, string, number, number, number];
const K = ["N/m", 7, 11, 9.4] as const;
const F0 = ["f0", "Hz", -2, 1, -0.74] as const;
const LAWS: Record<string, readonly Parameter[]> = {
  "maxwell-3": [["k", ...K], ["loss_factor", "", 0.001, 0.5, 0.03], F0],
  "kelvin-voigt": [
    ["k", ...K],
    ["c", "N·s/m", 6, 10, 8.9],
  ],
  zener: [
    ["k0", ...K],
    ["c", "N·s/m", 6, 10, 8.9],
    ["k1", "N/m", 7, 12, 10],
  ],
  springpot: [["k", ...K], ["alpha", "", 0.001, 0.5, 0.06], F0],
};
const WORDS: Record<string, string> = {
  k: "stiffness k",
  c: "dashpot c",
  k0: "static stiffness k0",
  k1: "stiffness of the damping branch k1",
  loss_factor: "loss factor at f0",
  alpha: "springpot exponent alpha",
  f0: "reference frequency f0",
};
const sliderOf = ([name, , min, max, usual]: Parameter) => ({ name, usual, min, max, step: "any" as const });
const valueOf = (p: Parameter): number => (p[1] ? 10 ** slid(sliderOf(p)) : slid(sliderOf(p)));

function plotsOf(law: Schemas["LawOut"]): PlotData[] {
  const one = (title: string, yName: string, time: boolean, log: boolean, y: Series["y"]): PlotData => ({
    title,
    time: false,
    xName: time ? "time [s]" : "frequency [Hz]",
    yName,
    logX: true,
    log,
    series: [{ name: title, colour: "blue", kind: "line", x: time ? law.time_s : law.frequency_hz, y }],
  });
  return [
    one("Storage", "N/m", false, true, law.storage_n_m),
    one("Loss", "N/m", false, true, law.loss_n_m),
    one("Loss factor", "ratio", false, false, law.loss_factor),
    one("Creep", "m/N", true, true, law.creep_m_n),
  ];
}

export function Laws() {
  const name = useChosen("law", Object.keys(LAWS));
  const parameters = LAWS[name] ?? [];
  const of = `${name}:${parameters.map((p) => `${p[0]}=${valueOf(p).toPrecision(4)}`).join(",")}`;
  const found = useAnswer(null, "law", async () => told(api.GET("/api/v1/law", { params: { query: { of } } })), of);
  const plots = useMemo(() => (found.data ? plotsOf(found.data) : []), [found.data]);
  return (
    <Card
      title="Laws"
      wide
      note="What a support does in each law: move a parameter, and see what it stores, loses and how it creeps."
    >
      <div class="tools">
        <Choice label="Law" kept="law" options={Object.keys(LAWS)} />
      </div>
      {parameters.map((p) => (
        <Slide key={p[0]} of={sliderOf(p)}>
          {WORDS[p[0]]} <b>{quantity(valueOf(p), p[1], 3)}</b>
        </Slide>
      ))}
      <Shown of={found}>
        {() => (
          <div class="pair">
            {plots.map((plot) => (
              <Plot key={plot.title} data={plot} height={200} together={plot.xName} />
            ))}
          </div>
        )}
      </Shown>
    </Card>
  );
}
