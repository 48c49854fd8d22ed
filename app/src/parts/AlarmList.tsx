// Findings that ask for a person, and the way to say that one has looked.
import { useState } from "preact/hooks";
import { api, type Alarm, Problem, told } from "../api/client";
import { may } from "../api/do";
import { Light, Time } from "./Bits";

function Acknowledge({ alarm, again }: { alarm: Alarm; again: () => void }) {
  const [open, setOpen] = useState(false);
  const [problem, setProblem] = useState<Problem | null>(null);
  if (!may("engineer")) return <span class="quiet">Engineers acknowledge alarms.</span>;
  if (!open)
    return (
      <button type="button" onClick={() => setOpen(true)}>
        Acknowledge
      </button>
    );
  const send = async (event: SubmitEvent): Promise<void> => {
    event.preventDefault();
    const comment = String(new FormData(event.currentTarget as HTMLFormElement).get("comment") ?? "");
    try {
      const path = { params: { path: { alarm_id: alarm.id } }, body: { comment } };
      await told(api.POST("/api/v1/alarms/{alarm_id}/acknowledge", path));
      setOpen(false);
      again();
    } catch (error) {
      setProblem(error instanceof Problem ? error : null);
    }
  };
  return (
    <form class="stack" onSubmit={(event) => void send(event)}>
      <label>
        What you saw, and what you do about it
        <textarea name="comment" required maxLength={2000} />
      </label>
      {problem && (
        <p class="error" role="alert">
          {problem.message}
        </p>
      )}
      <span>
        <button class="main">Acknowledge</button>{" "}
        <button type="button" onClick={() => setOpen(false)}>
          Not now
        </button>
      </span>
    </form>
  );
}

export function AlarmList({ alarms, again }: { alarms: readonly Alarm[]; again: () => void }) {
  return (
    <ul class="list">
      {alarms.map((alarm) => (
        <li key={alarm.id}>
          <p class="meta">
            <Light status={alarm.acknowledged_by ? "acknowledged" : "alarm"} />
            <Time at={alarm.time_utc} />
          </p>
          <p>{alarm.text}</p>
          {alarm.acknowledged_by ? (
            <p class="quiet">
              {alarm.acknowledged_by}
              {alarm.acknowledged_utc && (
                <>
                  , <Time at={alarm.acknowledged_utc} />
                </>
              )}
              : {alarm.comment}
            </p>
          ) : (
            <Acknowledge alarm={alarm} again={again} />
          )}
        </li>
      ))}
    </ul>
  );
}
