// Records given by hand: dropped or chosen, sent one after the other, watched until they are observed.
import { useState } from "preact/hooks";
import { api, Problem, sending, told } from "../api/client";
import { assetUrl } from "../shell/place";
import { Drop } from "./Drop";

export type Sent = { name: string; said: string; record?: string; failed: boolean };

export async function send(asset: string, file: File, description: File | undefined): Promise<Sent> {
  const form = new FormData();
  form.append("file", file);
  if (description) form.append("description", description);
  try {
    const to = { params: { path: { asset } }, ...sending(form) };
    const answer = api.POST("/api/v1/assets/{asset}/records", to);
    const { record_id: record } = (await told(answer)) as { record_id?: string };
    const said = (await answer).response.status === 200 ? "known already" : "taken; it is observed soon";
    return { name: file.name, said, failed: false, ...(record ? { record } : {}) };
  } catch (error) {
    const said = error instanceof Problem ? `${error.message} ${error.remedy}` : String(error);
    return { name: file.name, said, failed: true };
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
