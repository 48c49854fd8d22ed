// Where turbines stand, seen from above: north is up, and no picture of elsewhere lies below.
import type { Asset } from "../api/client";
import { asked, assetUrl } from "../shell/place";
import { sentence } from "../words/numbers";
import { csvFrom, ticksOf } from "./plot/series";

const [WIDTH, HIGH, EDGE, STEP, NAMED] = [1000, 300, 34, 28, 80];
const KM_PER_DEGREE = 111.2;
/** A mark of its own for each status, so that colour is not all that tells them apart. */
const MARKS: Record<string, string> = {
  alarm: "M-8-8h16v16h-16z",
  warning: "M0-9l9 9l-9 9l-9-9z",
  ok: "M-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0",
};

/** Positions in kilometres east and north of the middle of those that are known. */
function kilometres(assets: readonly Asset[]): Map<string, [number, number]> {
  const known = assets.filter((a) => typeof a.latitude_deg === "number");
  const middle = (of: (a: Asset) => number): number => known.reduce((s, a) => s + of(a), 0) / known.length;
  const [lat0, lon0] = [middle((a) => a.latitude_deg ?? 0), middle((a) => a.longitude_deg ?? 0)];
  const east = (a: Asset): number => ((((a.longitude_deg ?? 0) - lon0 + 540) % 360) - 180) * KM_PER_DEGREE;
  return new Map(
    known.map((a) => [
      a.name,
      [east(a) * Math.cos((lat0 * Math.PI) / 180), ((a.latitude_deg ?? 0) - lat0) * KM_PER_DEGREE],
    ]),
  );
}

/** Pixels of every turbine: to scale where positions are known, in rows below in order of names elsewhere. */
function drawn(assets: readonly Asset[]) {
  const at = kilometres(assets);
  const [x, y] = [0, 1].map((k) => [...at.values()].map((p) => p[k] ?? 0));
  const [west, south] = [Math.min(...(x ?? [])), Math.min(...(y ?? []))];
  const [wide, high] = [Math.max(...(x ?? [])) - west, Math.max(...(y ?? [])) - south];
  const scale = Math.min((WIDTH - 2 * EDGE) / (wide || 1), HIGH / (high || 1));
  const left = (WIDTH - wide * scale) / 2;
  const below = at.size ? high * scale + 2.6 * EDGE : 0;
  const across = Math.floor((WIDTH - 2 * EDGE) / STEP);
  let placed = 0;
  const marks = assets.map((asset) => {
    const km = at.get(asset.name);
    const [column, row] = [placed % across, Math.floor(placed / across)];
    if (km) return { asset, x: left + (km[0] - west) * scale, y: EDGE + (high - (km[1] - south)) * scale };
    placed++;
    return { asset, x: EDGE + column * STEP, y: below + EDGE + 8 + row * STEP };
  });
  const rows = Math.ceil(placed / across);
  return { marks, scale: at.size > 1 ? scale : 0, below, placed, height: below + (placed && rows * STEP + EDGE) };
}

export const mapCsv = (assets: readonly Asset[]): string =>
  csvFrom([
    ["turbine", "status", "latitude [°]", "longitude [°]"],
    ...assets.map((a) => [a.name, a.status, a.latitude_deg, a.longitude_deg]),
  ]);

export function Site({ assets }: { assets: readonly Asset[] }) {
  const last = ({ asset }: { asset: Asset }): number => Number(asset.status === "alarm"); // over the others
  const { marks, scale, below, placed, height } = drawn(assets);
  const length = (scale && ticksOf([0, WIDTH / 5 / scale], 1).at(-1)) || 0; // kilometres that a fifth of the width holds
  const chosen = asked("find")?.toLowerCase() ?? "";
  const size = marks.length > 200 ? 0.6 : 1;
  return (
    <svg class="map drawn" viewBox={`0 0 ${WIDTH} ${height}`} role="group" aria-label="Map of the turbines">
      {placed > 0 && (
        <text x={EDGE - 8} y={below + 18}>
          {placed === assets.length ? "No positions are known" : `${placed} without a position`}: jackettwin asset
          place NAME LATITUDE LONGITUDE
        </text>
      )}
      {scale > 0 && (
        <g>
          <path class="rule" d={`M${WIDTH - EDGE} ${below - 12}h${-length * scale}m0-4v8m${length * scale} 0v-8`} />
          <text x={WIDTH - EDGE} y={below - 20} text-anchor="end">{`${length} km · north is up`}</text>
        </g>
      )}
      {marks
        .toSorted((a, b) => last(a) - last(b))
        .map(({ asset, x, y }) => (
          <g key={asset.name} transform={`translate(${x.toFixed(1)} ${y.toFixed(1)})`}>
            <a
              href={assetUrl(asset.name)}
              tabIndex={-1}
              class={`light ${asset.status.replaceAll(" ", "-")}`}
              aria-label={`${asset.name}: ${asset.status}`}
            >
              <title>{[asset.name, sentence(asset.reason) || asset.status].join(": ")}</title>
              <path
                transform={`scale(${size})`}
                d={MARKS[asset.status] ?? MARKS["ok"] ?? ""}
                opacity={asset.name.toLowerCase().includes(chosen) ? 1 : 0.2}
              />
              {marks.length - placed <= NAMED && y < below && (
                <text y={20} text-anchor="middle">
                  {asset.name}
                </text>
              )}
            </a>
          </g>
        ))}
    </svg>
  );
}
