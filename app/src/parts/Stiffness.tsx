// The ground's stiffness through time, as every version of the model knows it.
import { useMemo } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, told } from "../api/client";
import { sentence } from "../words/numbers";
import { Card } from "./Bits";
import { OTHERS, stiffnessPlot, type Supports } from "./ground";
import { Plot } from "./plot/Plot";
import { Empty, Shown } from "./Shown";

/** What the adopted version knows, then the others, the newest first. */
async function everyVersion(asset: string): Promise<Supports[]> {
  const versions = await told(api.GET("/api/v1/assets/{asset}/versions", { params: { path: { asset } } }));
  const inOrder = versions.items.sort((a, b) => Number(b.adopted) - Number(a.adopted) || b.version - a.version);
  return Promise.all(
    inOrder.slice(0, 1 + OTHERS.length).map(({ version }) => {
      const params = { path: { asset }, query: { version } };
      return told(api.GET("/api/v1/assets/{asset}/supports", { params }));
    }),
  );
}

export default function Stiffness({ asset }: { asset: string }) {
  const found = useAnswer(asset, asset, () => everyVersion(asset));
  return (
    <Card title="The ground" wide>
      <Shown
        of={found}
        some={([adopted]) => adopted?.stiffness_in_time}
        none={<Empty title="Not followed yet">The stiffness of each day is followed from the third day on.</Empty>}
      >
        {(data) => <Drawn data={data} />}
      </Shown>
    </Card>
  );
}

function Drawn({ data: [adopted, ...others] }: { data: Supports[] }) {
  const plot = useMemo(() => adopted && stiffnessPlot(adopted, others), [adopted, others.length]);
  return (
    <>
      {adopted?.statement && <p>{sentence(adopted.statement)}</p>}
      {plot && <Plot data={plot} height={260} />}
    </>
  );
}
