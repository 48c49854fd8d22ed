// Modes in a table: the same columns wherever modes stand.
import type { Mode } from "../api/client";
import { assetUrl } from "../shell/place";
import { frequency, percent, words } from "../words/numbers";
import { type Column, Table } from "./Table";

type Own = "label" | "frequency_hz" | "frequency_std_hz" | "damping_ratio" | "damping_ratio_std";
type SomeMode = Pick<Mode, Own> & { damping_ratio_interval_90?: number[] | null };

interface ModeTableProps<T extends SomeMode> {
  asset: string;
  modes: readonly T[];
  id?: (mode: T) => string;
  first?: readonly Column<T>[];
  more?: readonly Column<T>[];
}

export function ModeTable<T extends SomeMode>({ asset, modes, id, first = [], more = [] }: ModeTableProps<T>) {
  const url = assetUrl(asset, "timeline");
  const f = (m: T): string => frequency(m.frequency_hz, m.frequency_std_hz);
  const zeta = ({ damping_ratio: ratio, damping_ratio_std: std, damping_ratio_interval_90: ends }: T): string =>
    ends ? `${percent(ratio)} (${percent(ends[0])} to ${percent(ends[1])})` : percent(ratio, std);
  const columns: Column<T>[] = [
    { title: "Mode", show: (m) => <a href={`${url}?mode=${m.label}`}>{words(m.label)}</a> },
    { title: "Frequency", unit: "Hz, 90 %", numeric: true, show: f },
    { title: "Damping ratio", unit: "%, 90 %", numeric: true, show: zeta },
  ];
  return <Table label="Modes" rows={modes} id={id ?? ((m) => m.label)} columns={[...first, ...columns, ...more]} />;
}
