// What answers take for granted, and the way to say that one has looked.
import { useState } from "preact/hooks";
import { useAsset } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { may } from "../api/do";
import { assetUrl } from "../shell/place";
import { count } from "../words/numbers";
import { Card, Form, Press } from "./Bits";
import { Empty, Shown } from "./Shown";

type Assumption = Schemas["AssumptionOut"];
type Parameters = Schemas["Knowledge"]["parameters"];

/** By how much a standard deviation of it moves what it moves most. */
function moved(one: Assumption, known: Parameters): string {
  const [name, most] = Object.entries(one.moves ?? {}).toSorted(([, a], [, b]) => Math.abs(b) - Math.abs(a))[0] ?? [];
  return name === undefined || most === undefined
    ? ""
    : `moves ${known[name]?.words ?? name} by ${(100 * Math.abs(most)).toPrecision(2)} %`;
}

function Confirm({ asset, one, done }: { asset: string; one: Assumption; done: (version: number) => void }) {
  const [open, setOpen] = useState(false);
  if (!open) return <Press words="Confirm" act={() => setOpen(true)} />;
  const send = async (text: (name: string) => string): Promise<void> => {
    const params = { path: { asset, key: one.key } };
    const path = "/api/v1/assets/{asset}/assumptions/{key}/confirm";
    done((await told(api.POST(path, { params, body: { comment: text("comment") } }))).version);
  };
  return (
    <Form words="Confirm" onSend={send} onLeave={() => setOpen(false)}>
      <label>
        How it was settled
        <textarea name="comment" required maxLength={2000} placeholder={one.settled_by ?? ""} />
      </label>
    </Form>
  );
}

/** So many are shown at first. */
const FIRST = 4;

type ListProps = { asset: string; known: Parameters; items: Assumption[]; done: (version: number) => void };

const List = ({ asset, known, items, done }: ListProps) => (
  <ul class="list">
    {items.map((one) => (
      <li key={one.key}>
        <p>{one.value}</p>
        <p class="quiet">
          {[moved(one, known), one.settled_by && `to settle it: ${one.settled_by}`].filter(Boolean).join("; ")}
        </p>
        {may("engineer") && <Confirm asset={asset} one={one} done={done} />}
      </li>
    ))}
  </ul>
);

export function Assumptions({ asset, known }: { asset: string; known: Parameters }) {
  const [version, setVersion] = useState<number | null>(null);
  const found = useAsset(asset, "/assumptions");
  return (
    <Card
      title="Open assumptions"
      wide
      note="What the answers hang on and nobody has settled, the weightiest first; σ is one standard deviation."
    >
      {version !== null && (
        <p class="said-done" role="status">
          Version {version} takes it as settled. <a href={assetUrl(asset, "model")}>Adopt it</a> once its records are
          observed.
        </p>
      )}
      <Shown
        of={found}
        some={(data) => data.items.some((one) => one.confirmed === false)}
        none={<Empty title="None is open" />}
      >
        {(data) => {
          const open = data.items.filter((one) => one.confirmed === false);
          return (
            <>
              <List asset={asset} known={known} items={open.slice(0, FIRST)} done={setVersion} />
              {open.length > FIRST && (
                <details>
                  <summary>{count(open.length - FIRST, "lighter one")}</summary>
                  <List asset={asset} known={known} items={open.slice(FIRST)} done={setVersion} />
                </details>
              )}
            </>
          );
        }}
      </Shown>
    </Card>
  );
}
