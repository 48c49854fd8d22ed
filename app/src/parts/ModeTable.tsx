// Modes in a table: the same columns wherever modes stand.
import { assetUrl } from "../shell/place";
import { frequency, percent, words } from "../words/numbers";
import { type Column, Table } from "./Table";

interface SomeMode {
  label: string;
  frequency_hz: number;
  frequency_std_hz: number | null;
  damping_ratio: number | null;
  damping_ratio_std: number | null;
}

interface ModeTableProps<T extends SomeMode> {
  asset: string;
  modes: readonly T[];
  id?: (mode: T) => string;
  first?: readonly Column<T>[];
  more?: readonly Column<T>[];
}

export function ModeTable<T extends SomeMode>({
  asset,
  modes,
  id = (m) => m.label,
  first = [],
  more = [],
}: ModeTableProps<T>) {
  return (
    <Table
      label="Modes"
      rows={modes}
      id={id}
      columns={[
        ...first,
        {
          title: "Mode",
          show: (m) => <a href={`${assetUrl(asset, "timeline")}?mode=${m.label}`}>{words(m.label)}</a>,
        },
        { title: "Frequency", unit: "Hz", numeric: true, show: (m) => frequency(m.frequency_hz, m.frequency_std_hz) },
        {
          title: "Damping ratio",
          unit: "%",
          numeric: true,
          show: (m) => percent(m.damping_ratio, m.damping_ratio_std),
        },
        ...more,
      ]}
    />
  );
}
