// What the API takes and answers, as its own document says it.
import { useAnswer } from "../api/answer";
import { Problem } from "../api/client";
import { Card, Find, Head } from "../parts/Bits";
import { Shown } from "../parts/Shown";
import { type Column, Table } from "../parts/Table";
import { asked } from "../shell/place";

type Parameter = { name: string; in: string; required?: boolean; description?: string };
type Said = { tags?: string[]; description?: string; parameters?: Parameter[] };
type Operation = Said & { requestBody?: { content: object } };
type Described = { info: { title: string; version: string }; paths: Record<string, Record<string, Operation>> };
type Row = Operation & { method: string; path: string };
const said = ({ name, required, description }: Parameter): string =>
  name + (required ? " (must be given)" : "") + (description ? ` – ${description}` : "");
const asks = ({ parameters = [], requestBody }: Row): string =>
  [...parameters.filter((p) => p.in === "query").map(said), ...Object.keys(requestBody?.content ?? {})].join(" · ");

async function read(): Promise<Described> {
  const answer = await fetch("/api/v1/openapi.json").catch(() => null);
  if (answer?.ok) return (await answer.json()) as Described;
  throw new Problem("offline", "The document does not come.");
}

const COLUMNS: Column<Row>[] = [
  { title: "Of", show: (r) => r.tags?.[0], by: (r) => r.tags?.[0] ?? "" },
  { title: "Call", show: (r) => <code>{`${r.method.toUpperCase()} ${r.path}`}</code> },
  { title: "What it does", show: (r) => <span class="prose">{r.description?.replaceAll("``", "")}</span> },
  { title: "What may be asked", show: (r) => <span class="prose">{asks(r)}</span> },
];

export default function Docs() {
  const found = useAnswer(null, "docs", read);
  const text = (asked("find") ?? "").toLowerCase();
  return (
    <>
      <Head title="The API">
        Everything this window shows and does, for programs: JSON under <code>/api/v1</code>, a token in{" "}
        <code>Authorization: Bearer</code>, lists by cursor, times in UTC. The{" "}
        <a href="/api/v1/openapi.json" data-leave>
          OpenAPI document
        </a>{" "}
        has every field and an example of each; <code>jackettwin.client</code> is the same in Python.
      </Head>
      <Shown of={found} lines={12}>
        {(data) => {
          const rows: Row[] = Object.entries(data.paths)
            .flatMap(([path, of]) => Object.entries(of).map(([method, one]) => ({ ...one, method, path })))
            .filter((r) => `${r.path} ${r.description ?? ""}`.toLowerCase().includes(text));
          return (
            <>
              <div class="tools">
                <Find label="Find a call" />
                <span class="quiet">
                  {data.info.title} {data.info.version}, {rows.length} calls
                </span>
              </div>
              <Card title="Calls" wide>
                <Table label="Calls" rows={rows} id={(r) => r.method + r.path} columns={COLUMNS} />
              </Card>
            </>
          );
        }}
      </Shown>
    </>
  );
}
