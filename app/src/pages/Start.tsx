// A turbine from its twin file and the files that this one names.
import { useState } from "preact/hooks";
import { api, told } from "../api/client";
import { may, textsOf, useDeed } from "../api/do";
import { Card, FormEnd, Head } from "../parts/Bits";
import { Empty } from "../parts/Shown";
import { assetUrl, go } from "../shell/place";

export default function Start() {
  const deed = useDeed();
  const [files, setFiles] = useState<File[]>([]);
  if (!may("engineer")) return <Empty title="Not allowed">Engineers add turbines.</Empty>;
  const twin = files.find((f) => /\.ya?ml$/.test(f.name));
  const send = async (event: SubmitEvent): Promise<void> => {
    event.preventDefault();
    const name = String(new FormData(event.currentTarget as HTMLFormElement).get("name") ?? "");
    const done = await deed.run(async () => {
      const others = await textsOf(files.filter((f) => f !== twin));
      const body = { name, twin: (await twin?.text()) ?? "", files: others, comment: "" };
      await told(api.POST("/api/v1/assets", { body }));
    });
    if (done) go(assetUrl(name, "records"));
  };
  return (
    <>
      <Head title="A new turbine">
        From a twin file and the files that it names. <code>jackettwin init STRUCTURE RECORD</code> writes a
        first one from a structure and records, and says what is missing.
      </Head>
      <Card title="Its files">
        <form class="stack" onSubmit={(event) => void send(event)}>
          <label>
            Name
            <input
              name="name"
              required
              pattern="[A-Za-z0-9][A-Za-z0-9_\-]*"
              maxLength={64}
              title="letters, digits, _ and -"
            />
          </label>
          <label>
            Twin file (YAML), structure, soil
            <input
              type="file"
              multiple
              required
              onChange={(event) => setFiles([...(event.currentTarget.files ?? [])])}
            />
          </label>
          {files.length > 0 && (
            <p class="quiet">
              {twin
                ? `${twin.name} is the twin file.`
                : "None of them is a YAML file: the twin file is missing."}
            </p>
          )}
          <FormEnd deed={deed} words={deed.busy ? "A worker reads it" : "Add"} />
        </form>
      </Card>
    </>
  );
}
