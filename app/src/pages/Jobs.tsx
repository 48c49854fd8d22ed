// What waits, what runs, what failed, and what to do about it.
import { useAnswer } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { may, useDeed } from "../api/do";
import { Ago, Card, Choice, Head, Light, Press } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import { Table } from "../parts/Table";
import { assetUrl, useChosen } from "../shell/place";

type Job = Schemas["JobOut"];
const WORDS: Record<string, string> = { queued: "waiting", leased: "under way" };
const STATES = Object.entries({ "": "All", ...WORDS, done: "done", failed: "failed", set_aside: "set aside" });
const KINDS: Record<string, string> = { observe: "find the modes of a record", know: "ask what all records say" };

export default function Jobs() {
  const state = useChosen("state", STATES);
  const query = { limit: 200, ...(state ? { state: state as Job["state"] } : {}) };
  const jobs = useAnswer("", `jobs ${state}`, () => told(api.GET("/api/v1/jobs", { params: { query } })));
  const deed = useDeed();
  const act = async (job: Job, what: "cancel" | "retry"): Promise<void> => {
    const path = { params: { path: { job_id: job.id } } };
    if (await deed.run(() => told(api.POST(`/api/v1/jobs/{job_id}/${what}`, path)))) jobs.again();
  };
  return (
    <>
      <Head title="Jobs">Every record and every estimate from all records is a job of a worker.</Head>
      <div class="tools">
        <Choice label="State" kept="state" options={STATES} />
        {deed.problem && <span class="error">{deed.problem.message}</span>}
      </div>
      <Card title="Newest first" wide>
        <Shown of={jobs} lines={8} none={<Empty title={state ? "No job of this kind" : "No job yet"} />}>
          {(data) => (
            <Table
              label="Jobs"
              rows={data.items}
              id={(j) => String(j.id)}
              columns={[
                { title: "State", show: (j) => <Light status={WORDS[j.state] ?? j.state} /> },
                { title: "What", show: (j) => KINDS[j.kind] ?? j.kind },
                {
                  title: "Of",
                  show: (j) => (
                    <a href={assetUrl(j.asset, j.record_id ? "records" : "", j.record_id)}>
                      {j.record_id ? `${j.asset} ${j.record_id.slice(0, 8)}` : j.asset}
                    </a>
                  ),
                },
                { title: "Asked", show: (j) => <Ago at={j.created_utc} /> },
                { title: "Tries", numeric: true, show: (j) => j.tries },
                { title: "Reason", show: (j) => <span class="prose">{String(j.reason?.["detail"] ?? "")}</span> },
                {
                  title: "Do",
                  show: (j) => {
                    const what = ["queued", "leased"].includes(j.state) ? "cancel" : "retry";
                    if (!may("engineer") || j.state === "done") return null;
                    const words = what === "cancel" ? "Cancel" : "Try again";
                    return <Press words={words} off={deed.busy} act={() => act(j, what)} />;
                  },
                },
              ]}
            />
          )}
        </Shown>
      </Card>
    </>
  );
}
