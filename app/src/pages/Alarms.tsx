// What asked for a person, what was worth saying, and who looked.
import { useAsset } from "../api/answer";
import { AlarmList } from "../parts/AlarmList";
import { Card, Choice, Head } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import Evidence from "../parts/Watched";
import { alarmMarks } from "../parts/modes";
import type { PageProps } from "../shell/place";
import { asked } from "../shell/place";

const KINDS = Object.entries({ "": "All", warning: "warnings", info: "notes" });
const STATES = Object.entries({ "": "Open", closed: "Closed" });

export default function Alarms({ asset }: PageProps) {
  const [kind, state] = [asked("severity") ?? "", asked("state") ?? ""];
  const alarms = useAsset(asset, "/alarms");
  const query = { limit: 200, ...(kind ? { severity: kind as "info" | "warning" } : {}) };
  const said = useAsset(asset, "/findings", query);
  return (
    <>
      <Head title="Alarms">
        A change of the structure, with its causes by probability. Whoever looked says what was seen and what is done.
      </Head>
      <div class="grid">
        <Card title="Asks for a person" wide more={<Choice label="Which" kept="state" options={STATES} />}>
          <Shown of={alarms} none={<Empty title="No alarm" />}>
            {(data) => {
              const shown = data.items.filter((a) => (state === "closed") === Boolean(a.closed_by));
              return shown.length ? (
                <AlarmList alarms={shown} again={alarms.again} whole />
              ) : (
                <Empty title={state === "closed" ? "None is closed" : "No open alarm"} />
              );
            }}
          </Shown>
        </Card>
        <Evidence asset={asset} marks={alarmMarks(alarms.data?.items)} />
        <Card title="Also said" wide more={<Choice label="Kind" kept="severity" options={KINDS} />}>
          <Shown
            of={said}
            some={(data) => data.items.some((f) => f.severity !== "alarm")}
            none={<Empty title="Nothing else" />}
          >
            {(data) => (
              <AlarmList alarms={data.items.filter((f) => f.severity !== "alarm")} again={said.again} whole />
            )}
          </Shown>
        </Card>
      </div>
    </>
  );
}
