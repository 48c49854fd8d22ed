// Parts that are loaded when they are first shown; if they do not come, the reader is told why.
import type { ComponentType } from "preact";
import { lazy } from "preact/compat";
import { Problem } from "../api/client";
import { Trouble } from "./Shown";

/** Nobody answers, or who answers has a newer window, whose parts have other names. */
async function unloaded(): Promise<{ default: ComponentType }> {
  const answers = await fetch("/").then((a) => a.ok).catch(() => false); // prettier-ignore
  const problem = answers
    ? new Problem("refused", "This page is older than its server.", "Try again: the newer page is loaded.")
    : new Problem("offline", "This part of the page could not be loaded.", "Try again once the server answers.");
  return { default: () => <Trouble problem={problem} again={() => location.reload()} /> };
}

export const later = <P,>(load: () => Promise<{ default: ComponentType<P> }>): ComponentType<P> =>
  lazy(() => load().catch(unloaded as () => Promise<{ default: ComponentType<P> }>));
