// Whose damping a mode's is: a bar by source, the measured interval above it, what is unexplained in outline.
import type { Schemas } from "../api/client";
import { assetUrl } from "../shell/place";
import { percent, words } from "../words/numbers";
import { csvFrom } from "./plot/series";

const SOURCES = ["structure", "soil", "rotor", "water"] as const;
const PAINT: Record<string, string> = { structure: "grey", soil: "orange", rotor: "sky", water: "blue" };

const paint = (source: string): string => `var(--${PAINT[source] ?? "grey"})`;

function Row({ asset, mode, most }: { asset: string; mode: Schemas["BudgetOut"]; most: number }) {
  const parts = SOURCES.map((name) => ({ name, value: mode.sources[name]?.value ?? 0 }));
  const sum = parts.reduce((total, part) => total + part.value, 0);
  const at = (ratio: number): number => (100 * ratio) / most;
  let from = 0;
  const measured = mode.measured;
  const said = parts.filter((p) => p.value > 0).map((p) => `${p.name} ${percent(p.value)} %`);
  return (
    <div>
      <a href={`${assetUrl(asset, "timeline")}?show=damping&mode=${mode.label}`}>{words(mode.label)}</a>
      <svg
        class="bar"
        viewBox="0 0 100 18"
        preserveAspectRatio="none"
        role="img"
        aria-label={`${words(mode.label)}: ${said.join(", ")}`}
      >
        {parts.map((part) => {
          const x = from;
          from += at(part.value);
          return (
            <rect
              key={part.name}
              style={{ fill: paint(part.name) }}
              {...{ x, y: 4, width: at(part.value), height: 10 }}
            />
          );
        })}
        {mode.unexplained ? (
          <rect class="unexplained" x={at(sum)} y="4" width={at(mode.unexplained)} height="10" />
        ) : null}
        {measured && (
          <path
            d={`M${at(measured.value)} 0v18M${at(measured.low ?? measured.value)} 1H${at(measured.high ?? measured.value)}`}
          />
        )}
      </svg>
      <span class="n">
        {measured ? percent(measured.value) : "–"}
        {mode.unexplained ? <span class="error">{` (${percent(mode.unexplained)} unexplained)`}</span> : ""}
      </span>
    </div>
  );
}

/** What is drawn, in per cent: a line a mode. */
export const budgetCsv = (modes: readonly Schemas["BudgetOut"][]): string =>
  csvFrom([
    ["mode", ...SOURCES, "unexplained", "measured", "low", "high"],
    ...modes.map(({ label, sources, unexplained, measured: m }) => [
      words(label),
      ...[...SOURCES.map((s) => sources[s]?.value), unexplained, m?.value, m?.low, m?.high].map((v) => v && 100 * v),
    ]),
  ]);

export function Budget({ asset, modes }: { asset: string; modes: readonly Schemas["BudgetOut"][] }) {
  const ends = modes.map((m) => [
    m.measured?.high ?? m.measured?.value ?? 0,
    SOURCES.reduce((sum, s) => sum + (m.sources[s]?.value ?? 0), 0),
  ]);
  const most = Math.max(...ends.flat(), 1e-6);
  const used = SOURCES.filter((s) => modes.some((m) => (m.sources[s]?.value ?? 0) > 0));
  return (
    <div class="drawn">
      <p class="keys">
        {used.map((s) => (
          <span key={s}>
            <i style={{ background: paint(s) }} aria-hidden="true" />
            {s}
          </span>
        ))}
        <span>
          <i class="unexplained" aria-hidden="true" />
          unexplained
        </span>
        <span>upright line: measured, with its 90 % interval</span>
      </p>
      <div class="budget">
        {modes.map((mode) => (
          <Row key={mode.label} asset={asset} mode={mode} most={most} />
        ))}
        <p class="ends">
          0 <span>{percent(most, null, 1)} %</span>
        </p>
      </div>
    </div>
  );
}
