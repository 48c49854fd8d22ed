// Light or dark: what the system says, unless the reader chose, or the link that was followed.
import { computed, signal } from "@preact/signals";
import { chosen as askedFor, keep } from "./place";

export type Theme = "light" | "dark";
const system = matchMedia("(prefers-color-scheme: dark)");
const systemDark = signal(system.matches);
const chosen = signal(askedFor("theme", ["", "light", "dark"]) || localStorage.getItem("theme"));
export const onPaper = signal(false); // paper is white, and what is drawn is as wide as it is
window.addEventListener("beforeprint", () => (onPaper.value = true));
window.addEventListener("afterprint", () => (onPaper.value = false));
onPaper.subscribe((now) => document.documentElement.toggleAttribute("data-paper", now));
export const theme = computed<Theme>(() =>
  !onPaper.value && (chosen.value === "dark" || (chosen.value === null && systemDark.value)) ? "dark" : "light",
);
system.addEventListener("change", () => (systemDark.value = system.matches));
theme.subscribe((now) => (document.documentElement.dataset["theme"] = now));

export function switchTheme(): void {
  const to = (chosen.value = theme.value === "dark" ? "light" : "dark");
  localStorage.setItem("theme", to);
  keep({ theme: to });
}

/** The value of one of our colours, for what is drawn and not styled. */
export const colour = (name: string): string =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
