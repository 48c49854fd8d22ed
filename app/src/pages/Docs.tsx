// What the API takes and answers, as its own document says it.
import { useAnswer } from "../api/answer";
import { Problem } from "../api/client";
import { Card, Find, Head } from "../parts/Bits";
import { Shown } from "../parts/Shown";
import { asked } from "../shell/place";

type Parameter = { name: string; in: string; required?: boolean; description?: string };
type Said = { tags?: string[]; description?: string; summary?: string; parameters?: Parameter[] };
type Operation = Said & { requestBody?: { content: object }; responses: object };
type Described = { info: { title: string; version: string }; paths: Record<string, Record<string, Operation>> };
type Row = Operation & { method: string; path: string };
const tagOf = (row: Row): string => row.tags?.[0] ?? "other";

async function read(): Promise<Described> {
  const answer = await fetch("/api/v1/openapi.json").catch(() => null);
  if (!answer?.ok) throw new Problem("offline", "The document does not come.");
  return (await answer.json()) as Described;
}

function Call({ row }: { row: Row }) {
  const asks = (row.parameters ?? []).filter((p) => p.in === "query");
  const refused = Object.keys(row.responses).filter((status) => status >= "400");
  return (
    <li>
      <code>
        <b>{row.method.toUpperCase()}</b> {row.path}
      </code>
      <p>{(row.description ?? row.summary ?? "").replaceAll("``", "")}</p>
      {asks.length > 0 && (
        <p class="quiet">
          {asks.map((p, i) => (
            <span key={p.name}>
              {i > 0 && " · "}
              <code>{p.name}</code>
              {`${p.required ? " (must be given)" : ""}${p.description ? ` – ${p.description}` : ""}`}
            </span>
          ))}
        </p>
      )}
      <p class="quiet">
        {row.requestBody && `Sent: ${Object.keys(row.requestBody.content).join(", ")}. `}
        {refused.length > 0 && `May answer ${refused.join(", ")} with a problem document.`}
      </p>
    </li>
  );
}

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
          const byTag = new Map<string, Row[]>();
          for (const row of rows) byTag.set(tagOf(row), [...(byTag.get(tagOf(row)) ?? []), row]);
          return (
            <>
              <div class="tools">
                <Find label="Find a call" />
                <span class="quiet">
                  {data.info.title} {data.info.version}, {rows.length} calls
                </span>
              </div>
              <div class="grid">
                {[...byTag].map(([tag, own]) => (
                  <Card key={tag} title={tag} wide>
                    <ul class="list">
                      {own.map((r) => (
                        <Call key={r.method + r.path} row={r} />
                      ))}
                    </ul>
                  </Card>
                ))}
              </div>
            </>
          );
        }}
      </Shown>
    </>
  );
}
