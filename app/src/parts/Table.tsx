// A table whose columns can be sorted; on a phone each row is a card.
import type { ComponentChildren } from "preact";
import { asked, keep, useChosen } from "../shell/place";
import { Press } from "./Bits";

export interface Column<T> {
  title: string;
  unit?: string;
  show: (row: T) => ComponentChildren;
  /** What rows are sorted by; without it the column cannot be. */
  by?: (row: T) => string | number | null;
  numeric?: boolean;
}

/** A column of numbers, by which rows are sorted. */
export const number = <T,>(
  title: string,
  unit: string,
  by: (row: T) => number | null | undefined,
  { say = String }: { say?: (value: number, row: T) => ComponentChildren } = {},
): Column<T> => {
  const show = (row: T): ComponentChildren => {
    const value = by(row);
    return typeof value === "number" ? say(value, row) : "–";
  };
  return { title, unit, numeric: true, show, by: (row) => by(row) ?? null };
};

interface TableProps<T> {
  label: string;
  columns: readonly Column<T>[];
  rows: readonly T[];
  id: (row: T) => string;
  /** The title of the column that rows are sorted by at first. */
  sorted?: string;
  mark?: (row: T) => string;
  /** Rows that are shown until all are asked for. */
  most?: number;
}

/** Columns from which on a phone shows each row as a card. */
const MANY = 3;

function compared(a: string | number | null, b: string | number | null): number {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

/** The address holds by which column rows are sorted, with a minus from the greatest on, and whether all are shown. */
export function Table<T>(props: TableProps<T>) {
  const name = props.label.toLowerCase().replaceAll(" ", "-");
  const [sort, all] = [`sort-${name}`, `all-${name}`];
  const titles = props.columns.flatMap((c) => (c.by ? [c.title] : []));
  const usual = props.sorted ?? "";
  const order = useChosen(sort, [usual, ...titles, ...titles.map((t) => `-${t}`)]);
  const [title, down] = [order.replace(/^-/, ""), order.startsWith("-")];
  const by = props.columns.find((c) => c.title === title)?.by;
  const sorted = by ? props.rows.toSorted((a, b) => compared(by(a), by(b)) * (down ? -1 : 1)) : props.rows;
  const rows = sorted.slice(0, asked(all) ? Infinity : (props.most ?? Infinity));
  const sortBy = (one: string): void => keep({ [sort]: one === order ? `-${one}` : one === usual ? null : one });
  return (
    <div class="scroll" tabIndex={0} role="region" aria-label={props.label}>
      <table class={props.columns.length > MANY ? "many" : ""}>
        <thead>
          <tr>
            {props.columns.map((c) => (
              <th
                key={c.title}
                class={c.numeric ? "n" : ""}
                scope="col"
                aria-sort={title !== c.title ? undefined : down ? "descending" : "ascending"}
              >
                {c.by ? (
                  <button type="button" onClick={() => sortBy(c.title)}>
                    {c.title}
                    <span aria-hidden="true">{title !== c.title ? "" : down ? " ↓" : " ↑"}</span>
                  </button>
                ) : (
                  c.title
                )}
                {c.unit && <small>{c.unit}</small>}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={props.id(row)} class={props.mark?.(row) ?? ""}>
              {props.columns.map((c) => (
                <td
                  key={c.title}
                  class={c.numeric ? "n" : ""}
                  data-label={c.unit ? `${c.title} [${c.unit}]` : c.title}
                >
                  {c.show(row)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {rows.length < sorted.length && <Press words={`Show all ${sorted.length}`} act={() => keep({ [all]: "1" })} />}
    </div>
  );
}
