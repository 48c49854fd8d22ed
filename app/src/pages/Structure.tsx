// How the foundation moves: its updated complex modes in phase, and what was measured of each.
import { useEffect, useRef } from "preact/hooks";
import { show, type View } from "../../../src/jackettwin/report/templates/view.js";
import "../../../src/jackettwin/report/templates/view.css";
import { useAnswer } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { Card } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import type { PageProps } from "../shell/place";
import { asked, keep } from "../shell/place";
import { theme } from "../shell/theme";
import { day } from "../words/time";

type Drawn = Schemas["StructureOut"];

/** Pictures of one page turn together. */
const open = new Set<View>();

function Picture({ drawn }: { drawn: Drawn }) {
  const root = useRef<HTMLDivElement>(null);
  const view = useRef<View | null>(null);
  const dark = theme.value;
  useEffect(() => {
    if (!root.current) return;
    const made = (view.current = show(root.current, drawn));
    for (const other of open) {
      other.link(made);
      made.link(other);
    }
    open.add(made);
    return () => {
      open.delete(made);
      made.gone();
    };
  }, [drawn]);
  useEffect(() => view.current?.repaint(), [dark]);
  return <div class="in-space" ref={root} />;
}

function Version({ asset, version }: { asset: string; version: number | undefined }) {
  const query = version === undefined ? {} : { version };
  const found = useAnswer(asset, `structure ${asset} ${version ?? ""}`, () =>
    told(api.GET("/api/v1/assets/{asset}/structure", { params: { path: { asset }, query } })),
  );
  return (
    <Card
      title={version === undefined ? "As adopted" : `Version ${version}`}
      wide={version === undefined && !asked("beside")}
      note="Every part in its own phase: what is heavily damped does not pass through rest together. Green points are what the sensors measured, in the model's amplitude and phase."
    >
      <Shown of={found} lines={12} empty={(data) => (data.nodes?.length ? null : <Nothing />)}>
        {(data) => <Picture drawn={data} />}
      </Shown>
    </Card>
  );
}

export default function Structure({ asset }: PageProps) {
  const versions = useAnswer(asset, `versions ${asset}`, () =>
    told(api.GET("/api/v1/assets/{asset}/versions", { params: { path: { asset } } })),
  );
  const others = versions.data?.items.filter((v) => !v.adopted) ?? [];
  const beside = asked("beside");
  return (
    <>
      <div class="head">
        <h1>Structure</h1>
        {others.length > 0 && (
          <label class="end">
            Beside it{" "}
            <select
              value={beside ?? ""}
              onChange={(event) => keep({ beside: event.currentTarget.value || null })}
            >
              <option value="">nothing</option>
              {others.map((v) => (
                <option key={v.version} value={String(v.version)}>
                  {`version ${v.version} of ${day(v.created_utc)}`}
                </option>
              ))}
            </select>
          </label>
        )}
      </div>
      <div class="grid">
        <Version asset={asset} version={undefined} />
        {beside && <Version asset={asset} version={Number(beside)} />}
      </div>
    </>
  );
}

const Nothing = () => (
  <Empty title="Nothing to draw yet">
    <p>The structure is drawn with its updated modes, once records have been observed and no record waits.</p>
  </Empty>
);
