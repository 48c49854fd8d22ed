// How modes look: the colour by kind, as in the report.
import type { Mode } from "../api/client";

const KINDS: Record<string, string> = {
  fore_aft: "blue",
  side_side: "vermillion",
  torsion: "green",
  heave: "purple",
};
const OTHERS = ["blue", "vermillion", "green", "purple", "orange", "sky"];

export function modeColour(label: string): string {
  const [, kind = "", number = "0"] = /^(.*)_(\d+)$/.exec(label) ?? [];
  return KINDS[kind] ?? OTHERS[Number(number) % OTHERS.length] ?? "grey";
}

/** Modes through time by label, labels in the order of their frequencies. */
export function byLabel(modes: readonly Mode[]): Map<string, Mode[]> {
  const found = new Map<string, Mode[]>();
  for (const mode of modes) {
    const rows = found.get(mode.label);
    if (rows) rows.push(mode);
    else if (mode.label) found.set(mode.label, [mode]);
  }
  for (const rows of found.values()) rows.sort((a, b) => a.time_utc.localeCompare(b.time_utc));
  const middle = (rows: Mode[]): number => rows[Math.floor(rows.length / 2)]?.frequency_hz ?? 0;
  return new Map([...found].sort(([, a], [, b]) => middle(a) - middle(b)));
}
