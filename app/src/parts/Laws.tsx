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

type Parameter = Schemas["LawParameterOut"];

/** A parameter's slider, in decades between its bounds. */
const sliderOf = ({ name, low, high }: Parameter) => {
  const [min, max] = [Math.log10(low), Math.log10(high)];
  return { name, usual: (min + max) / 2, min, max, step: "any" as const };
};
const valueOf = (p: Parameter): number => 10 ** slid(sliderOf(p));

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
  const known = useAnswer(null, "laws", async () => told(api.GET("/api/v1/laws")));
  return (
    <Card
      title="Laws"
      wide
      note="What a support does in each law: move a parameter, and see what it stores, loses and how it creeps."
    >
      <Shown of={known}>{({ items }) => <Law laws={items} />}</Shown>
    </Card>
  );
}

function Law({ laws }: { laws: readonly Schemas["LawFamilyOut"][] }) {
  const name = useChosen(
    "law",
    laws.map((law) => law.name),
  );
  const parameters = laws.find((law) => law.name === name)?.parameters ?? [];
  const of = `${name}:${parameters.map((p) => `${p.name}=${valueOf(p).toPrecision(4)}`).join(",")}`;
  const found = useAnswer(null, "law", async () => told(api.GET("/api/v1/law", { params: { query: { of } } })), of);
  const plots = useMemo(() => (found.data ? plotsOf(found.data) : []), [found.data]);
  return (
    <>
      <div class="tools">
        <Choice label="Law" kept="law" options={laws.map((law) => law.name)} />
      </div>
      {parameters.map((p) => (
        <Slide key={p.name} of={sliderOf(p)}>
          {p.words} {p.name} <b>{quantity(valueOf(p), p.unit === "-" ? "" : p.unit, 3)}</b>
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
    </>
  );
}
