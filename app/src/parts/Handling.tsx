// What people do with a finding: look, hand on, say something, mute, close, open again.
import { useState } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, type Finding, told } from "../api/client";
import { may } from "../api/do";
import { Form, Press, Time } from "./Bits";

type Act = "acknowledge" | "assign" | "comment" | "mute" | "close" | "reopen";
const DAY_MS = 86_400_000;
const SPANS = Object.entries({ 1: "a day", 7: "a week", 30: "a month", 365: "a year" });
/** Of each act: its button, what is asked, and how it is told afterwards. */
const ACTS: Record<string, readonly [string, string, string]> = {
  acknowledge: ["Acknowledge", "What you saw, and what you do about it", "acknowledged"],
  assign: ["Assign", "Why to that person", "assigned"],
  comment: ["Comment", "What is to be said", "said"],
  mute: ["Mute", "Why nobody is to be told", "muted"],
  unmute: ["", "", "ended the mute"],
  close: ["Close", "Why it needs nobody any more", "closed"],
  reopen: ["Reopen", "Why it needs somebody after all", "reopened"],
};

/** How a finding stands: what its light says. */
export const standing = (f: Finding): string =>
  f.closed_by ? "closed" : f.muted_until_utc ? "muted" : f.acknowledged_by ? "acknowledged" : f.severity;

function possible(f: Finding): Act[] {
  if (f.closed_by) return ["reopen", "comment"];
  const own: Act[] = ["assign", "comment", f.muted_until_utc ? "reopen" : "mute", "close"];
  return f.severity === "alarm" && !f.acknowledged_by ? ["acknowledge", ...own] : own;
}

async function sent(f: Finding, act: Act, text: (name: string) => string): Promise<unknown> {
  const comment = text("comment");
  if (act === "acknowledge") {
    const params = { path: { alarm_id: f.id } };
    return told(api.POST("/api/v1/alarms/{alarm_id}/acknowledge", { params, body: { comment } }));
  }
  const until_utc = new Date(Date.now() + Number(text("days")) * DAY_MS).toISOString();
  const body = {
    assign: { to: text("to") || null, comment },
    comment: { comment },
    mute: { until_utc, comment },
    close: { reason: comment },
    reopen: { comment },
  }[act];
  const params = { path: { finding_id: f.id } };
  return told(api.POST(`/api/v1/findings/{finding_id}/${act}`, { params, body } as never));
}

/** Buttons, one of which opens a form. */
export function Handling({ finding, again }: { finding: Finding; again: () => void }) {
  const [act, setAct] = useState<Act | null>(null);
  if (!may("engineer"))
    return finding.severity === "alarm" && !finding.acknowledged_by ? (
      <span class="quiet">Engineers acknowledge alarms.</span>
    ) : null;
  if (act === null)
    return (
      <p class="acts">
        {possible(finding).map((one) => (
          <Press key={one} words={ACTS[one]?.[0] ?? one} act={() => setAct(one)} />
        ))}
      </p>
    );
  const send = async (text: (name: string) => string): Promise<void> => {
    await sent(finding, act, text);
    setAct(null);
    again();
  };
  const must = act === "acknowledge" || act === "comment" || act === "close";
  return (
    <Form words={ACTS[act]?.[0] ?? act} onSend={send} onLeave={() => setAct(null)}>
      {act === "assign" && (
        <label>
          To whom (a user's name; empty for nobody)
          <input name="to" maxLength={64} defaultValue={finding.assigned_to ?? ""} autocomplete="off" />
        </label>
      )}
      {act === "mute" && (
        <label>
          For how long
          <select name="days">
            {SPANS.map(([days, words]) => (
              <option key={days} value={days}>
                {words}
              </option>
            ))}
          </select>
        </label>
      )}
      <label>
        {ACTS[act]?.[1]}
        <textarea name="comment" required={must} maxLength={2000} />
      </label>
    </Form>
  );
}

/** Who did what with a finding, oldest first. */
export function History({ finding }: { finding: Finding }) {
  const stands = [finding.acknowledged_utc, finding.assigned_to, finding.muted_until_utc, finding.closed_utc];
  const found = useAnswer(finding.asset, `finding ${finding.id} ${stands.join()}`, () =>
    told(api.GET("/api/v1/findings/{finding_id}", { params: { path: { finding_id: finding.id } } })),
  );
  const acts = found.data?.history ?? [];
  if (!acts.length) return null;
  return (
    <ol class="acts-done">
      {acts.map((one, i) => (
        <li key={i}>
          <b>{one.by}</b> {ACTS[one.action]?.[2] ?? one.action}
          {one.to ? ` to ${one.to}` : ""}
          {one.until_utc && " until "}
          {one.until_utc && <Time at={one.until_utc} />}, <Time at={one.time_utc} />
          {one.comment && <>: {one.comment}</>}
        </li>
      ))}
    </ol>
  );
}
