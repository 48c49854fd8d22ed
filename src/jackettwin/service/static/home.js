// Reload the list when something happened, at most once a second.
"use strict";
let due = null;
const source = new EventSource("/api/v1/events");
const live = document.getElementById("live");
source.onopen = () => { live.textContent = "live"; };
source.onerror = () => { live.textContent = "connection lost, trying again"; };
async function refresh() {
  due = null;
  const answer = await fetch("/", { headers: { Accept: "text/html" } });
  if (!answer.ok) return;
  const page = new DOMParser().parseFromString(await answer.text(), "text/html");
  document.querySelector("main").replaceWith(page.querySelector("main"));
}
for (const kind of ["record", "observation", "finding", "asset"])
  source.addEventListener(kind, () => { due = due ?? setTimeout(refresh, 1000); });
