// Records given by hand: dropped or chosen, sent one after the other, watched until they are observed.
import { useState } from "preact/hooks";
import { me, problemOf } from "../api/client";
import { assetUrl } from "../shell/place";
import { Drop } from "./Drop";

export type Sent = { name: string; said: string; record?: string; failed: boolean };

export async function send(asset: string, file: File, description: File | undefined): Promise<Sent> {
  const form = new FormData();
  form.append("file", file);
  if (description) form.append("description", description);
  const token = me.value?.csrf_token;
  const headers: HeadersInit = token ? { "X-CSRF-Token": token } : {};
  try {
    const url = `/api/v1/assets/${encodeURIComponent(asset)}/records`;
    const answer = await fetch(url, { method: "POST", body: form, headers });
    const body = (await answer.json().catch(() => ({}))) as { record_id?: string; records?: number };
    if (!answer.ok) {
      const problem = problemOf(answer.status, body);
      return { name: file.name, said: [problem.message, problem.remedy].filter(Boolean).join(". "), failed: true };
    }
    const said = answer.status === 200 ? "known already" : "taken; it is observed soon";
    return { name: file.name, said, failed: false, ...(body.record_id ? { record: body.record_id } : {}) };
  } catch {
    return { name: file.name, said: "the server does not answer; send it again", failed: true };
  }
}

/** A JSON beside a file describes it: r1.parquet and r1.json, or one JSON for all. */
export function paired(files: readonly File[]): [File, File | undefined][] {
  const stem = (file: File): string => file.name.replace(/\.[^.]*$/, "");
  const described = files.filter((f) => f.name.endsWith(".json"));
  const records = files.filter((f) => !f.name.endsWith(".json"));
  if (!records.length) return described.map((f) => [f, undefined]);
  const alone = described.length === 1 ? described[0] : undefined;
  return records.map((f) => [f, described.find((d) => stem(d) === stem(f)) ?? alone]);
}

export function Upload({ asset }: { asset: string }) {
  const [sent, setSent] = useState<Sent[]>([]);
  const [left, setLeft] = useState(0);
  const take = async (files: File[]): Promise<void> => {
    for (const [i, [file, description]] of paired(files).entries()) {
      setLeft(paired(files).length - i);
      const one = await send(asset, file, description);
      setSent((old) => [one, ...old]);
    }
    setLeft(0);
  };
  return (
    <Drop label="Records to send" onFiles={(files) => void take(files)}>
      Drop records here, or choose them; a JSON of the same name describes what a file does not say.
      {left > 0 && <p role="status">Sending, {left} to go</p>}
      <ul class="list" aria-label="Sent">
        {sent.map((one, i) => (
          <li key={sent.length - i} class={one.failed ? "error" : ""}>
            {one.record ? <a href={assetUrl(asset, "records", one.record)}>{one.name}</a> : one.name}: {one.said}
          </li>
        ))}
      </ul>
    </Drop>
  );
}
