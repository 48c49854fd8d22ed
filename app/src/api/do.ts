// Something that a reader does: it is under way, or it failed and the server said why.
import { useState } from "preact/hooks";
import { api, ended, me, Problem, told, type Schemas } from "./client";

export function useDeed() {
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
  return { busy, problem: problem?.kind === "login" && me.value && !ended.value ? null : problem, run };
}

/** Somebody is logged in. What another one has left open is not theirs to read. */
export function enter(user: Schemas["Me"]): void {
  if (ended.value && me.value?.name !== user.name) location.reload();
  else [me.value, ended.value] = [user, false];
}

export async function askWho(): Promise<void> {
  try {
    enter(await told(api.GET("/api/v1/me")));
  } catch (error) {
    if (error instanceof Problem && error.kind !== "login") setTimeout(() => void askWho(), 3000);
  }
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
