// Parts that are loaded when they are first shown; without a connection they say so.
import type { ComponentType } from "preact";
import { lazy } from "preact/compat";
import { Problem } from "../api/client";
import { Trouble } from "./Shown";

function Unloaded() {
  const problem = new Problem(
    "offline",
    "This part of the page could not be loaded.",
    "Try again once the server answers.",
  );
  return <Trouble problem={problem} again={() => location.reload()} />;
}

export function later<P>(load: () => Promise<{ default: ComponentType<P> }>): ComponentType<P> {
  return lazy(() => load().catch(() => ({ default: Unloaded as ComponentType<P> })));
}
