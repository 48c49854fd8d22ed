// A question that a page asks, and asks again when something happened.
import { useEffect, useRef, useState } from "preact/hooks";
import type { Readable } from "openapi-typescript-helpers";
import { api, ended, me, Problem, told } from "./client";
import { connection, happened } from "./events";
import type { paths } from "./schema";

type Got<P> = P extends { get: { responses: { 200: { content: { "application/json": infer A } } } } } ? A : never;
type OfRecord = keyof { [P in keyof paths as P extends `/api/v1/records/{record_id}${infer S}` ? S : never]: 0 };
type OfAsset = keyof { [P in keyof paths as P extends `/api/v1/assets/{asset}${infer S}` ? S : never]: 0 };

export interface Answer<T> {
  /** What was answered last; undefined before the first answer. */
  data: T | undefined;
  /** Why the newest question has no answer; data beside it is old. */
  problem: Problem | undefined;
  again: () => void;
}

type State<T> = { key: string; data?: T | undefined; problem?: Problem | undefined };

/** Ask, and ask again when an event of the asset ("" for any) arrives or the question changes. */
export function useAnswer<T>(
  asset: string | null,
  key: string,
  ask: () => Promise<T>,
  /** What the question is about; the last answer stays until this one's comes. */
  about = "",
): Answer<T> {
  const [state, setState] = useState<State<T>>({ key });
  const [tries, setTries] = useState(0);
  const newest = useRef(0);
  const events = asset === null ? 0 : (happened.value[asset] ?? 0);
  const [lost, closed] = [connection.value === "lost", ended.value];
  const again = (): void => setTries((n) => n + 1);
  useEffect(() => {
    if (!state.problem?.after) return;
    const timer = setTimeout(again, 1000 * state.problem.after);
    return () => clearTimeout(timer);
  }, [state.problem]);
  useEffect(() => {
    const number = ++newest.current;
    const keep = (data: T | undefined, problem: Problem | undefined): void => {
      if (number !== newest.current || (problem?.kind === "login" && me.value)) return; // the frame asks who it is
      setState((old) => ({ key, data: data ?? (old.key === key ? old.data : undefined), problem }));
    };
    ask().then(
      (data) => keep(data, undefined),
      (error: unknown) => keep(undefined, error instanceof Problem ? error : new Problem("server", String(error))),
    );
  }, [key, about, events, tries, lost, closed]);
  const { data, problem }: State<T> = state.key === key ? state : { key };
  return { data, problem, again };
}

/** Ask what the API says at an address below an asset or a record. */
function useBelow<P extends keyof paths>(asset: string | null, path: P, of: object, query: object) {
  return useAnswer<Readable<Got<paths[P]>>>(asset, JSON.stringify([path, of, query]), () =>
    told(api.GET(path as never, { params: { path: of, query } } as never)),
  );
}

/** Ask of an asset, and again with each of its events. */
export const useAsset = <S extends OfAsset>(asset: string, below: S, query: object = {}) =>
  useBelow(asset, `/api/v1/assets/{asset}${below}`, { asset }, query);

/** Ask of a record, which does not change. */
export const useRecord = <S extends OfRecord>(record: string, below: S, query: object = {}) =>
  useBelow(null, `/api/v1/records/{record_id}${below}`, { record_id: record }, query);
