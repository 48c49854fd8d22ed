// What a page shows while an answer is not there, old, or refused: designed once, the same everywhere.
import type { ComponentChildren } from "preact";
import type { Answer } from "../api/answer";
import type { Problem } from "../api/client";
import { sentence } from "../words/numbers";
import { Press } from "./Bits";

const HEADINGS: Record<Problem["kind"], string> = {
  offline: "No connection",
  login: "Logged out",
  role: "Not allowed",
  missing: "Not here",
  refused: "Refused",
  soon: "Not yet",
  server: "The server failed",
};

export function Trouble({ problem, again, title }: { problem: Problem; again?: () => void; title?: string }) {
  return (
    <div class={`state ${problem.kind}`} role="alert">
      {title && <h1>{title}</h1>}
      <h3>{HEADINGS[problem.kind]}</h3>
      <p>{sentence(problem.message)}</p>
      {problem.remedy && <p>{sentence(problem.remedy)}</p>}
      {again && problem.kind !== "role" && problem.kind !== "missing" && <Press words="Try again" act={again} />}
    </div>
  );
}

export function Empty({ title, children }: { title: string; children?: ComponentChildren }) {
  return (
    <div class="state">
      <h3>{title}</h3>
      {children && <div>{children}</div>}
    </div>
  );
}

interface ShownProps<T> {
  of: Answer<T>;
  /** Whether there is something to show; usually if there are items. */
  some?: (data: T) => unknown;
  /** What to say if there is nothing. */
  none?: ComponentChildren;
  lines?: number;
  /** Of a page that is nothing else. */
  title?: string;
  children: (data: T) => ComponentChildren;
}

const hasItems = (data: unknown): unknown => (data as { items?: unknown[] }).items?.length ?? true;

/** An answer: bones while it is awaited, its problem, what to do if it is empty, or itself. */
export function Shown<T>({ of, some = hasItems, none, lines = 4, title, children }: ShownProps<T>) {
  if (of.data === undefined) {
    if (of.problem) return <Trouble problem={of.problem} again={of.again} {...(title ? { title } : {})} />;
    return (
      <div class="bones" role="status" aria-label="Reading">
        {Array.from({ length: lines }, (_, i) => (
          <span key={i} />
        ))}
      </div>
    );
  }
  return (
    <>
      {of.problem && (
        <p class="old" role="status">
          Older than it should be: {of.problem.message}
        </p>
      )}
      {none && !some(of.data) ? none : children(of.data)}
    </>
  );
}
