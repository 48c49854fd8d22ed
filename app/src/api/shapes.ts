// What the API describes as an object of any kind, as the pages read it.
import type { Mode } from "./client";
import { count } from "../words/numbers";

type Own = "label" | "frequency_hz" | "frequency_std_hz" | "damping_ratio" | "damping_ratio_std";
export type Estimated = Pick<Mode, Own>;
export type KnownMode = Estimated & { mode: number; records: number };

export interface KnownParameter {
  median: number;
  interval_90: [number, number] | null;
  unit: string;
  words: string;
  text: string;
  day?: string;
}

export interface Knowledge {
  law?: string;
  status?: string;
  records?: number;
  until_utc?: string;
  /** Whether there is a report. */
  reported?: boolean;
  /** The questions of the report's first page, and what is said to each in short. */
  answers?: { question: string; answer: string }[];
  parameters?: Record<string, KnownParameter>;
}

/** What an estimate is of: 730 records up to 2025-12-01. */
export const recordsOf = ({ records, until_utc }: Knowledge): string =>
  count(records ?? 0, "record") + (until_utc ? ` up to ${until_utc.slice(0, 10)}` : "");
