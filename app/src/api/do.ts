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

export const isTwin = (file: File): boolean => /\.ya?ml$/.test(file.name);
export const namesOf = (files: readonly File[]): string => files.map((f) => f.name).join(", ") || "none yet";

/** A twin file and the files beside it, as they are sent. */
export async function twinOf(files: readonly File[]): Promise<{ twin: string; files: Record<string, string> }> {
  const twin = files.find(isTwin);
  if (!twin) throw new Problem("refused", "None of them is a YAML file: the twin file is missing.");
  const others = files.filter((f) => f !== twin).map(async (f) => [f.name, await f.text()] as const);
  return { twin: await twin.text(), files: Object.fromEntries(await Promise.all(others)) };
}
