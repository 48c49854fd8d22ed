// A turbine from what lies in a folder: a twin file, or a structure and records, of which a twin is drafted.
import { useState } from "preact/hooks";
import { api, me, Problem, type Schemas, sending, told } from "../api/client";
import { isTwin, may, namesOf, twinOf, useDeed } from "../api/do";
import { Card, Field, Form, Head, Pick, Press } from "../parts/Bits";
import { Drop } from "../parts/Drop";
import { InSpace } from "../parts/InSpace";
import { Trouble } from "../parts/Shown";
import { paired, send } from "../parts/Upload";
import { assetUrl, go } from "../shell/place";

type Draft = Schemas["DraftOut"];
const STRUCTURE = /\.(ya?ml|dat|inp|sacs?)$|^[^.]*$|sacinp/i;

/** Add a turbine, and send its records one after the other. */
async function begin(name: string, twin: object, records: readonly File[]): Promise<void> {
  const body = { name, comment: "", ...(twin as { twin: string; files: Record<string, string> }) };
  await told(api.POST("/api/v1/assets", { body }));
  for (const [record, description] of paired(records)) await send(name, record, description);
  go(assetUrl(name, "records"));
}

const NameField = () => (
  <Field
    label="Name of the turbine"
    name="name"
    required
    pattern="[A-Za-z0-9][A-Za-z0-9_\-]*"
    maxLength={64}
    title="letters a to z, digits, _ and -, a letter or digit first"
  />
);

export default function Start() {
  const [files, setFiles] = useState<File[]>([]);
  const [whole, setWhole] = useState(false);
  const take = async (given: File[]): Promise<void> => {
    const yaml = await Promise.all(given.filter(isTwin).map((f) => f.text()));
    setWhole(yaml.some((text) => /^structure:/m.test(text)));
    setFiles(given);
  };
  if (me.value && !may("engineer"))
    return <Trouble title="A new turbine" problem={new Problem("role", "Engineers add turbines.")} />;
  return (
    <>
      <Head title="A new turbine">
        From a twin file and what it names, or from a structure and records: then a twin is drafted, and you confirm
        each guess.
      </Head>
      <div class="grid">
        <Card title="Its files" wide>
          <Drop label="Files of the turbine" onFiles={(given) => void take(given)}>
            Drop a folder or files here: a structure (SACS, SubDyn, YAML) and records, or a twin file.
            <p>{files.length > 0 && namesOf(files)}</p>
          </Drop>
        </Card>
        {whole && (
          <Card title="A twin file is there" wide>
            <Form
              words="Add"
              busy="A worker reads it"
              onSend={async (text) => begin(text("name"), await twinOf(files), [])}
            >
              <NameField />
            </Form>
          </Card>
        )}
        {!whole && files.length > 0 && <Drafting key={namesOf(files)} files={files} />}
      </div>
    </>
  );
}

function Drafting({ files }: { files: readonly File[] }) {
  const [named, setNamed] = useState(files.find((f) => STRUCTURE.test(f.name))?.name ?? "");
  const [draft, setDraft] = useState<Draft | null>(null);
  const deed = useDeed();
  const structure = files.find((f) => f.name === named);
  const records = files.filter((f) => f !== structure);
  const ask = (): Promise<boolean> =>
    deed.run(async () => {
      const form = new FormData();
      if (structure) form.append("structure", structure);
      const [first, description] = paired(records)[0] ?? [];
      if (first) form.append("record", first);
      if (description) form.append("description", description);
      setDraft(await told(api.POST("/api/v1/drafts", sending(form))));
    });
  return (
    <>
      <Card title="Which is what" wide>
        <div class="tools">
          <Pick
            label="Structure"
            value={named}
            options={[["", "none of them"], ...files.map((f) => f.name)]}
            onChoose={setNamed}
          />
          <span class="quiet">Records: {namesOf(records)}</span>
          <Press
            words={deed.busy ? "A worker reads them" : "Draft a twin"}
            look="main"
            off={deed.busy || !structure || !records.length}
            act={ask}
          />
        </div>
        {deed.problem && <Trouble problem={deed.problem} />}
      </Card>
      {draft && structure && <Confirming draft={draft} structure={structure} records={records} />}
    </>
  );
}

function Confirming({ draft, structure, records }: { draft: Draft; structure: File; records: File[] }) {
  const add = async (text: (name: string) => string): Promise<void> =>
    begin(text("name"), { twin: text("twin"), files: { [draft.structure]: await structure.text() } }, records);
  return (
    <>
      <Card
        title={draft.drawn.title ?? "The structure"}
        wide
        note="Arrows are the sensors, in the direction they measure."
      >
        <InSpace drawn={draft.drawn} />
      </Card>
      <Card title="Is each guess right?" wide>
        <Form words="Add" busy="A worker reads it" onSend={add}>
          {draft.places.map((place) => (
            <label class="tick" key={place.channel}>
              <input type="checkbox" required /> {place.channel}:{" "}
              {place.lacks ? `left out, lacks ${place.lacks}` : place.why}
            </label>
          ))}
          {draft.missing.length > 0 && (
            <ul class="list">
              {draft.missing.map((said) => (
                <li key={said}>{said}</li>
              ))}
            </ul>
          )}
          <label>
            The twin file: change what is wrong
            <textarea name="twin" rows={24} spellcheck={false} defaultValue={draft.twin} />
          </label>
          <NameField />
        </Form>
      </Card>
    </>
  );
}
