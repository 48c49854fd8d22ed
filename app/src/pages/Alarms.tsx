// What asked for a person, what was worth saying, and who looked.
import { useAnswer } from "../api/answer";
import { api, told } from "../api/client";
import { AlarmList } from "../parts/AlarmList";
import { Card, Choice, Light, Time } from "../parts/Bits";
import { Handling, History, standing } from "../parts/Handling";
import { Empty, Shown } from "../parts/Shown";
import type { PageProps } from "../shell/place";
import { asked, assetUrl, keep } from "../shell/place";

const KINDS = [
  ["", "All"],
  ["warning", "warnings"],
  ["info", "notes"],
] as const;

const STATES = [
  ["", "Open"],
  ["closed", "Closed"],
] as const;

export default function Alarms({ asset }: PageProps) {
  const [kind, state] = [asked("severity") ?? "", asked("state") ?? ""];
  const path = { asset };
  const alarms = useAnswer(asset, `alarms ${asset}`, () =>
    told(api.GET("/api/v1/assets/{asset}/alarms", { params: { path } })),
  );
  const query = { limit: 200, ...(kind ? { severity: kind as "info" | "warning" } : {}) };
  const said = useAnswer(asset, `findings ${asset} ${kind}`, () =>
    told(api.GET("/api/v1/assets/{asset}/findings", { params: { path, query } })),
  );
  return (
    <>
      <div class="head">
        <h1>Alarms</h1>
        <p>
          A change of the structure, with its causes by probability. Whoever looked says what was seen and
          what is done.
        </p>
      </div>
      <div class="grid">
        <Card
          title="Asks for a person"
          wide
          more={
            <Choice
              label="Which"
              value={state}
              options={STATES}
              onChoose={(one) => keep({ state: one || null })}
            />
          }
        >
          <Shown of={alarms} empty={(data) => (data.items.length ? null : <Empty title="No alarm" />)}>
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
        <Card
          title="Also said"
          wide
          more={
            <Choice
              label="Kind"
              value={kind}
              options={KINDS}
              onChoose={(k) => keep({ severity: k || null })}
            />
          }
        >
          <Shown
            of={said}
            empty={(data) =>
              data.items.some((f) => f.severity !== "alarm") ? null : <Empty title="Nothing else" />
            }
          >
            {(data) => (
              <ul class="list">
                {data.items
                  .filter((f) => f.severity !== "alarm")
                  .map((f) => (
                    <li key={f.id}>
                      <p class="meta">
                        <Light status={standing(f)} />
                        <Time at={f.time_utc} />
                        {f.record_id && <a href={assetUrl(asset, "records", f.record_id)}>the record</a>}
                      </p>
                      <p>{f.text}</p>
                      {(f.assigned_to ?? f.muted_until_utc ?? f.closed_by) && <History finding={f} />}
                      {f.severity === "warning" && <Handling finding={f} again={said.again} />}
                    </li>
                  ))}
              </ul>
            )}
          </Shown>
        </Card>
      </div>
    </>
  );
}
