import { expect, test } from "vitest";
import * as numbers from "../src/words/numbers";
import cases from "./numbers.json";

type Spoken = Record<string, (...given: unknown[]) => string>;

test.each(cases as [string, unknown[], string][])("%s of %j is as the report writes it", (name, given, said) => {
  expect((numbers as unknown as Spoken)[name]?.(...given)).toBe(said);
});
