// Findings that ask for a person, what is known of each, and the way to say that one has looked.
import { useEffect } from "preact/hooks";
import type { Finding } from "../api/client";
import { sentence } from "../words/numbers";
import { asked, assetUrl } from "../shell/place";
import { Light, Time } from "./Bits";
import { Handling, History, standing } from "./Handling";

const ROOM_MS = 60 * 86_400_000;

/** The record, or the days before and after: what a reader looks at first. */
function evidence(alarm: Finding): string {
  if (alarm.record_id) return assetUrl(alarm.asset, "records", alarm.record_id);
  const began = alarm.params["began_low"];
  const first = typeof began === "string" ? Date.parse(began) : Date.parse(alarm.time_utc);
  const at = (ms: number): string => encodeURIComponent(new Date(ms).toISOString());
  const range = `from=${at(first - ROOM_MS)}&to=${at(Date.parse(alarm.time_utc) + ROOM_MS)}`;
  return `${assetUrl(alarm.asset, "timeline")}?${range}`;
}

/** Whether a link is about it, which stands out then. */
export const linked = (alarm: Finding): boolean => asked("alarm") === String(alarm.id);

export function AlarmList({ alarms, again }: { alarms: readonly Finding[]; again: () => void }) {
  useEffect(() => document.querySelector("li.here")?.scrollIntoView({ block: "center" }), [asked("alarm")]);
  return (
    <ul class="list">
      {alarms.map((alarm) => (
        <li key={alarm.id} class={linked(alarm) ? "here" : ""}>
          <p class="meta">
            <Light status={standing(alarm)} />
            <span>
              {alarm.severity === "alarm" && "found "}
              <a href={`${assetUrl(alarm.asset, "alarms")}?alarm=${alarm.id}`}>
                <Time at={alarm.time_utc} />
              </a>
            </span>
            {alarm.assigned_to && <span>with {alarm.assigned_to}</span>}
            {alarm.muted_until_utc && (
              <span>
                until <Time at={alarm.muted_until_utc} />
              </span>
            )}
            <a href={evidence(alarm)}>{alarm.record_id ? "the record" : "the days around it"}</a>
          </p>
          <p>{sentence(alarm.text)}</p>
          <Causes causes={alarm.params["causes"] as Record<string, number> | undefined} />
          {(alarm.severity === "alarm" || standing(alarm) !== alarm.severity) && <History finding={alarm} />}
          {alarm.severity !== "info" && <Handling finding={alarm} again={again} />}
        </li>
      ))}
    </ul>
  );
}

/** Every likely cause with its probability, as a bar. */
const Causes = ({ causes = {} }: { causes?: Record<string, number> | undefined }) => (
  <ul class="causes">
    {Object.entries(causes).map(([cause, probability]) => (
      <li key={cause}>
        <meter value={probability} aria-label={cause} /> {sentence(`${Math.round(100 * probability)} % ${cause}`)}
      </li>
    ))}
  </ul>
);
