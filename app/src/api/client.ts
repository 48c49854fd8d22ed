// The API, typed by its own OpenAPI document (schema.d.ts is generated; see docs/design/014-window.md).
import { signal } from "@preact/signals";
import createClient from "openapi-fetch";
import type { Readable } from "openapi-typescript-helpers";
import type { components, paths } from "./schema";

type All = components["schemas"];
/** What the API answers with, by the names of its document. */
export type Schemas = { [Name in keyof All]: Readable<All[Name]> };
export type Asset = Schemas["AssetOut"];
export type Mode = Schemas["ModeOut"];
export type Alarm = Schemas["AlarmOut"];
export type Finding = Schemas["FindingOut"];
export type RecordOut = Schemas["RecordOut"];

/** Who is logged in: undefined while nobody has asked, null if the server knows nobody. */
export const me = signal<Schemas["Me"] | null | undefined>(undefined);
/** Whether the session of who was logged in has ended: the page stays, with what is written there, behind a login. */
export const ended = signal(false);

export const api = createClient<paths>({ baseUrl: location.origin });
api.use({
  onRequest({ request }) {
    const token = me.value?.csrf_token;
    if (token && request.method !== "GET") request.headers.set("X-CSRF-Token", token);
    return request;
  },
});

/** What went wrong, as the server says it (RFC 9457), or as this browser does. */
export class Problem extends Error {
  constructor(
    readonly kind: "offline" | "login" | "role" | "missing" | "refused" | "soon" | "server",
    detail: string,
    readonly remedy: string = "",
    readonly field: string = "",
    /** After how many seconds to ask again. */
    readonly after: number = 0,
  ) {
    super(detail);
  }
}

const KINDS: Record<number, Problem["kind"]> = { 401: "login", 403: "role", 404: "missing" };

/** Make a problem of an answer that is none. */
export function problemOf(status: number, said: unknown, after = 0): Problem {
  const told = (typeof said === "object" && said !== null ? said : {}) as Record<string, unknown>;
  const text = (value: unknown): string => (typeof value === "string" ? value : "");
  const kind = KINDS[status] ?? (after ? "soon" : status >= 500 ? "server" : "refused");
  const allowed = text(told["allowed"]) && `; allowed: ${text(told["allowed"])}`;
  const detail = text(told["detail"]) || `the server answered ${status}`;
  return new Problem(kind, detail + allowed, text(told["remedy"]), text(told["field"]), after);
}

type Fetched<T> = { data?: T; error?: unknown; response: Response };

/** Return what an answer holds; throws a Problem if it is none. */
export async function told<T>(answer: Promise<Fetched<T>>): Promise<T> {
  let fetched: Fetched<T>;
  try {
    fetched = await answer;
  } catch {
    throw new Problem("offline", "The server does not answer.", "It is asked again by itself.");
  }
  if (fetched.response.ok) return fetched.data as T;
  if (fetched.response.status === 401) [ended.value, me.value] = [!!me.value, me.value || null];
  throw problemOf(fetched.response.status, fetched.error, Number(fetched.response.headers.get("Retry-After")));
}

/** Files as they are sent. */
export const sending = (form: FormData) => ({ body: form as never, bodySerializer: () => form });

type Paged<T> = { items: T[]; next_cursor?: string | null };

/** Return a whole list, page by page, at most so many. */
export async function everything<T>(
  page: (cursor: string | undefined) => Promise<Paged<T>>,
  most = 200_000,
): Promise<T[]> {
  const items: T[] = [];
  let cursor: string | undefined;
  do {
    const found = await page(cursor);
    items.push(...found.items);
    cursor = found.next_cursor ?? undefined;
  } while (cursor !== undefined && items.length < most);
  return items;
}
