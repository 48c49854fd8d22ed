// Which model speaks for the turbine, and what another one would say of the same records.
import { useState } from "preact/hooks";
import { type Answer, useAsset } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { may, namesOf, twinOf, useDeed } from "../api/do";
import { Card, Field, Form, Head, Press, Time } from "../parts/Bits";
import { Drop } from "../parts/Drop";
import { Shown } from "../parts/Shown";
import { number, Table } from "../parts/Table";
import type { PageProps } from "../shell/place";
import { keep, useChosen } from "../shell/place";
import { scientific, words } from "../words/numbers";

type Versions = Schemas["Page_VersionOut_"];

function spoken(quantity: string): string {
  const [name = "", ...rest] = quantity.split(" ");
  const what: Record<string, string> = { frequency_hz: "frequency [Hz]", damping_ratio: "damping ratio" };
  return name === "ln"
    ? `ln ${rest.join(" ").replaceAll("_", " ")}`
    : `${words(name)} ${what[rest.join(" ")] ?? rest.join(" ")}`;
}

const column = (title: string, by: (c: Schemas["ChangeOut"]) => number | null | undefined, digits = 3) =>
  number(title, "", by, { say: (v) => scientific(v, digits) });

function Comparison({ asset, version }: { asset: string; version: number }) {
  const found = useAsset(asset, "/comparison", { version });
  return (
    <Card
      title={`Version ${version} beside the adopted one`}
      wide
      note="Of the same records; differences also in standard deviations of what the adopted version is sure of."
    >
      <Shown of={found}>
        {(data) => (
          <Table
            label="Differences"
            rows={data.changes}
            id={(c) => c.quantity}
            columns={[
              { title: "Quantity", show: (c) => spoken(c.quantity) },
              column("Adopted", (c) => c.adopted, 4),
              column(`Version ${version}`, (c) => c.other, 4),
              column("Difference", (c) => c.difference),
              column("In std", (c) => c.in_standard_deviations, 2),
            ]}
          />
        )}
      </Shown>
    </Card>
  );
}

function NewVersion({ asset, versions }: { asset: string; versions: Answer<Versions> }) {
  const [files, setFiles] = useState<File[]>([]);
  const [said, setSaid] = useState("");
  const send = async (text: (name: string) => string): Promise<void> => {
    const body = { ...(await twinOf(files)), comment: text("comment") };
    const made = await told(api.PUT("/api/v1/assets/{asset}", { params: { path: { asset } }, body }));
    setSaid(`Version ${made.version} is there; records are observed by it too. It counts once it is adopted.`);
    versions.again();
  };
  return (
    <Card title="A new version">
      <Drop label="Twin file and the files that it names" onFiles={setFiles}>
        The twin file (YAML) and the files that it names: {namesOf(files)}
      </Drop>
      <Form words="Add" busy="A worker reads it" onSend={send}>
        <Field label="Why" name="comment" maxLength={1000} required />
        {said && <p role="status">{said}</p>}
      </Form>
    </Card>
  );
}

export default function Model({ asset }: PageProps) {
  const versions = useAsset(asset, "/versions");
  const deed = useDeed();
  const others = versions.data?.items.filter((v) => !v.adopted).map((v) => String(v.version));
  const other = Number(useChosen("compare", others && ["", ...others]));
  const adopt = async (version: number): Promise<void> => {
    const path = { params: { path: { asset, version } } };
    if (await deed.run(() => told(api.POST("/api/v1/assets/{asset}/versions/{version}/adopt", path))))
      versions.again();
  };
  return (
    <>
      <Head title="Model">
        Every version of the twin stays, with what it knows. One is adopted: its answers count. Adopting an earlier
        one rolls back.
      </Head>
      <div class="grid">
        <Card title="Versions" wide>
          {deed.problem && <p class="error">{deed.problem.message}</p>}
          <Shown of={versions}>
            {(data) => (
              <Table
                label="All versions"
                rows={data.items.toReversed()}
                id={(v) => String(v.version)}
                columns={[
                  { title: "Version", show: (v) => v.version },
                  { title: "Counts", show: (v) => (v.adopted ? <b>adopted</b> : "") },
                  { title: "Made", show: (v) => <Time at={v.created_utc} short /> },
                  { title: "By", show: (v) => v.created_by },
                  { title: "Why", show: (v) => <span class="prose">{v.comment}</span> },
                  { title: "Observed", unit: "records", numeric: true, show: (v) => v.observations },
                  { title: "Model", show: (v) => <code>{v.model_hash.slice(0, 8)}</code> },
                  {
                    title: "Do",
                    show: (v) =>
                      v.adopted ? null : (
                        <>
                          <Press words="Compare" act={() => keep({ compare: String(v.version) })} />{" "}
                          {may("engineer") && <Press words="Adopt" off={deed.busy} act={() => adopt(v.version)} />}
                        </>
                      ),
                  },
                ]}
              />
            )}
          </Shown>
        </Card>
        {other > 0 && <Comparison asset={asset} version={other} />}
        {may("engineer") && <NewVersion asset={asset} versions={versions} />}
      </div>
    </>
  );
}
