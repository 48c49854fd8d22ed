// A support law by slider: what it stores and loses at each frequency, and how it creeps.
import { useMemo } from "preact/hooks";
import { useAnswer, useAsset } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { quantity } from "../words/numbers";
import { asked, useChosen } from "../shell/place";
import { Card, Choice, Slide, slid } from "./Bits";
import { Plot } from "./plot/Plot";
import type { PlotData, Series } from "./plot/series";
import { Shown } from "./Shown";

type Parameter = Schemas["LawParameterOut"];
type Twin = Pick<Schemas["Knowledge"], "law" | "parameters">;

/** What the twin knows of a law's parameter: of the first direction, or of any stiffness where it has another law. */
const own = (twin: Twin, { name, unit }: Parameter) =>
  Object.entries(twin.parameters).find(([key]) => key.startsWith(`${name}_`))?.[1] ??
  Object.values(twin.parameters).find((known) => unit === "N/m" && known.unit === unit);
/** A parameter's slider, in decades between its bounds; at first at the twin's own value. */
const sliderOf = (twin: Twin, parameter: Parameter) => {
  const [min, max] = [Math.log10(parameter.low), Math.log10(parameter.high)];
  const known = Math.log10(own(twin, parameter)?.median ?? NaN);
  const usual = known >= min && known <= max ? Number(known.toFixed(3)) : (min + max) / 2;
  return { name: parameter.name, usual, min, max, step: "any" as const };
};

function plotsOf(law: Schemas["LawOut"]): PlotData[] {
  const one = (title: string, yName: string, time: boolean, log: boolean, y: Series["y"]): PlotData => ({
    title,
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

export function Laws({ asset }: { asset: string }) {
  const twin = useAsset(asset, "/twin");
  const known = useAnswer(null, "laws", async () => told(api.GET("/api/v1/laws")));
  return (
    <Card
      title="Laws"
      wide
      note="What a support does in each law: move a parameter, and see what it stores, loses and how it creeps."
    >
      <Shown of={known}>{({ items }) => twin.data && <Law laws={items} twin={twin.data.parameters} />}</Shown>
    </Card>
  );
}

function Law({ laws, twin }: { laws: readonly Schemas["LawFamilyOut"][]; twin: Twin }) {
  const names = laws.map((law) => law.name);
  const usual = names.find((one) => one === twin.law);
  const name = useChosen("law", names, usual);
  const valueOf = (p: Parameter): number => 10 ** slid(sliderOf(twin, p));
  const parameters = laws.find((law) => law.name === name)?.parameters ?? [];
  const of = `${name}:${parameters.map((p) => `${p.name}=${valueOf(p).toPrecision(4)}`).join(",")}`;
  const found = useAnswer(null, "law", async () => told(api.GET("/api/v1/law", { params: { query: { of } } })), of);
  const plots = useMemo(() => (found.data ? plotsOf(found.data) : []), [found.data]);
  return (
    <>
      <div class="tools">
        <Choice label="Law" kept="law" options={names} {...(usual ? { usual } : {})} />
      </div>
      {parameters.map((p) => (
        <Slide key={p.name} of={sliderOf(twin, p)}>
          {p.words} <b>{quantity(valueOf(p), p.unit)}</b>
          {own(twin, p) && asked(p.name) === null && ` (the twin's ${own(twin, p)?.words})`}
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
