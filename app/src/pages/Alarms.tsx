// What asked for a person, what was worth saying, and who looked.
import { useAsset } from "../api/answer";
import { AlarmList, linked } from "../parts/AlarmList";
import { Card, Choice, Head } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import Evidence from "../parts/Watched";
import { alarmMarks } from "../parts/modes";
import type { PageProps } from "../shell/place";
import { useChosen } from "../shell/place";

const KINDS = Object.entries({ "": "All", warning: "warnings", info: "notes" });
const STATES = Object.entries({ "": "Open", closed: "Closed" });

export default function Alarms({ asset }: PageProps) {
  const [kind, state] = [useChosen("severity", KINDS), useChosen("state", STATES)];
  const alarms = useAsset(asset, "/alarms");
  const query = { limit: 200, ...(kind ? { severity: kind as "info" | "warning" } : {}) };
  const said = useAsset(asset, "/findings", query);
  const shown = alarms.data?.items.filter((a) => linked(a) || (state === "closed") === Boolean(a.closed_by)) ?? [];
  const others = said.data?.items.filter((f) => f.severity !== "alarm") ?? [];
  const every = [...(alarms.data?.items ?? []), ...others].map((a) => String(a.id));
  useChosen("alarm", alarms.data && said.data && every);
  const none = state === "closed" ? "None is closed" : alarms.data?.items.length ? "No open alarm" : "No alarm";
  return (
    <>
      <Head title="Alarms">
        A change of the structure, with its causes by probability. Whoever looked says what was seen and what is done.
      </Head>
      <div class="grid">
        <Card title="Asks for a person" wide more={<Choice label="Which" kept="state" options={STATES} />}>
          <Shown of={alarms} some={() => shown.length} none={<Empty title={none} />}>
            {() => <AlarmList alarms={shown} again={alarms.again} />}
          </Shown>
        </Card>
        <Evidence asset={asset} marks={alarmMarks(alarms.data?.items)} />
        <Card title="Also said" wide more={<Choice label="Kind" kept="severity" options={KINDS} />}>
          <Shown of={said} some={() => others.length} none={<Empty title="Nothing else" />}>
            {() => <AlarmList alarms={others} again={said.again} />}
          </Shown>
        </Card>
      </div>
    </>
  );
}
