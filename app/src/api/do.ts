// Something that a reader does: it is under way, or it failed and the server said why.
import { useState } from "preact/hooks";
import { me, Problem } from "./client";

export interface Deed {
  busy: boolean;
  problem: Problem | null;
  run: (deed: () => Promise<unknown>) => Promise<boolean>;
}

export function useDeed(): Deed {
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<Problem | null>(null);
  const run = async (deed: () => Promise<unknown>): Promise<boolean> => {
    setBusy(true);
    setProblem(null);
    try {
      await deed();
      return true;
    } catch (error) {
      setProblem(error instanceof Problem ? error : new Problem("server", String(error)));
      return false;
    } finally {
      setBusy(false);
    }
  };
  return { busy, problem, run };
}

const ROLES = ["viewer", "engineer", "admin"];
/** Whether who is logged in may do what asks for a role; the server decides, this only hides what would fail. */
export const may = (role: string): boolean => ROLES.indexOf(me.value?.role ?? "") >= ROLES.indexOf(role);

/** The texts of files by name, as a twin's are sent. */
export const textsOf = async (files: readonly File[]): Promise<Record<string, string>> =>
  Object.fromEntries(await Promise.all(files.map(async (f) => [f.name, await f.text()] as const)));
