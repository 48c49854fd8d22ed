// One turbine: what the API says, drawn; nothing is computed here but scales.
"use strict";
const asset = document.getElementById("asset").dataset.asset;
const api = (path) => fetch(`/api/v1/assets/${asset}${path}`).then((r) => { if (!r.ok) throw new Error(r.statusText); return r.json(); });
// Okabe and Ito's colours, told apart by everybody
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f"];
const SYMBOLS = ["circle", "square", "diamond", "triangle-up", "cross", "x", "star", "hexagon"];
const text = (value) => value === null || value === undefined ? "–" : value;
const fixed = (value, digits) => value === null || value === undefined ? "–" : value.toFixed(digits);
const counted = (n, what) => `${n} ${what}${n === 1 ? "" : "s"}`;
const words = (label) => label.replaceAll("_", " ");

function row(cells, numeric) {
  const tr = document.createElement("tr");
  cells.forEach((cell, i) => {
    const td = document.createElement("td");
    td.textContent = text(cell);
    if (numeric.includes(i)) td.className = "n";
    tr.append(td);
  });
  return tr;
}

function fill(id, rows, numeric) {
  document.querySelector(`#${id} tbody`).replaceChildren(...rows.map((cells) => row(cells, numeric)));
}

let reported = null;
function report(state, version) {
  if (!state || state === reported) return;
  reported = state;
  const frame = document.getElementById("report"), link = document.createElement("a");
  link.href = frame.src = `/assets/${asset}/report?version=${version}`;
  link.textContent = "The newest report by itself";
  frame.hidden = false;
  document.getElementById("reported").replaceChildren(link);
}

async function twin() {
  const known = await api("/twin");
  fill("modes", known.modes.map((m) => [
    words(m.label), fixed(m.frequency_hz, 4), fixed(m.frequency_std_hz, 4),
    fixed(m.damping_ratio === null ? null : 100 * m.damping_ratio, 2),
    fixed(m.damping_ratio_std === null ? null : 100 * m.damping_ratio_std, 2), m.records]), [1, 2, 3, 4, 5]);
  const supports = known.parameters.parameters || {};
  fill("supports", Object.entries(supports).map(([name, p]) => [
    words(name), p.median.toPrecision(3), p.interval_90 ? `${p.interval_90[0].toPrecision(3)} to ${p.interval_90[1].toPrecision(3)}` : null, p.unit]), [1, 2]);
  const percent = (v) => !v ? null : `${(100 * v.value).toFixed(2)}${v.low === null ? "" : ` (${(100 * v.low).toFixed(2)} to ${(100 * v.high).toFixed(2)})`}`;
  fill("budget", (known.parameters.budget || []).map((m) => [words(m.label), percent(m.measured),
    ...["structure", "soil", "rotor", "water"].map((source) => percent(m.sources[source]))]), [1, 2, 3, 4, 5]);
  report(known.parameters.law && `${known.version} ${known.parameters.until_utc} ${known.parameters.records}`, known.version);
  document.getElementById("law").textContent = known.parameters.law
    ? `Law ${known.parameters.law}, from ${counted(known.parameters.records, "record")}; posterior: ${known.parameters.status}.`
    : "Not estimated yet: this is done when no record waits.";
  document.getElementById("sentence").textContent = known.records
    ? `${counted(known.records, "record")} of ${counted(known.days, "day")}, ${known.first_utc.slice(0, 16).replace("T", " ")} to ${known.last_utc.slice(0, 16).replace("T", " ")} UTC. ${known.status}`
    : "No record has been observed yet.";
}

async function modes() {
  const items = [];
  let cursor = null;
  do {
    const page = await api(`/modes?limit=5000${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);
    items.push(...page.items);
    cursor = page.next_cursor;
  } while (cursor && items.length < 50000);
  const labels = [...new Set(items.map((m) => m.label).filter(Boolean))].sort();
  const trace = (label, i, y, error) => {
    const own = items.filter((m) => m.label === label && y(m) !== null);
    return {
      x: own.map((m) => m.time_utc), y: own.map(y), name: words(label), mode: "markers", type: "scatter",
      marker: { color: COLOURS[i % 8], symbol: SYMBOLS[i % 8], size: 8 }, error_y: { type: "data", thickness: 1, ...error(own) },
      hovertemplate: "%{y:.4g}<br>%{x}<extra>" + words(label) + "</extra>",
    };
  };
  const layout = (title, type) => ({
    margin: { l: 60, r: 10, t: 10, b: 40 }, yaxis: { title: { text: title }, type }, xaxis: { title: { text: "UTC" }, type: "date" },
    legend: { orientation: "h", y: 1.15 }, font: { family: "system-ui, sans-serif", size: 13 },
  });
  const config = { displaylogo: false, responsive: true };
  Plotly.react("frequency", labels.map((l, i) => trace(l, i, (m) => m.frequency_hz, (own) => ({ array: own.map((m) => m.frequency_std_hz) }))), layout("frequency [Hz]", "log"), config);
  Plotly.react("damping", labels.map((l, i) => trace(l, i, (m) => m.damping_ratio === null ? null : 100 * m.damping_ratio, (own) => ({
    array: own.map((m) => m.damping_ratio_interval_95 ? 100 * (m.damping_ratio_interval_95[1] - m.damping_ratio) : 0),
    arrayminus: own.map((m) => m.damping_ratio_interval_95 ? 100 * (m.damping_ratio - m.damping_ratio_interval_95[0]) : 0), symmetric: false,
  }))), layout("damping ratio [%]", "log"), config);
}

async function findings() {
  const [page, own] = await Promise.all([api("/findings?limit=50"), api("")]);
  const shown = page.items.filter((f) => f.severity !== "info");
  const lost = (own.records.refused ?? 0) + (own.records.set_aside ?? 0);
  const none = lost ? { text: `${lost} of the records were refused or set aside: their remarks are below.`, severity: "warning" } : { text: "Nothing to beware of.", severity: "" };
  const list = (shown.length ? shown : [none]).map((f) => {
    const li = document.createElement("li");
    li.className = f.severity;
    li.textContent = f.time_utc ? `${f.time_utc.slice(0, 16).replace("T", " ")} ${f.severity}: ${f.text}` : f.text;
    return li;
  });
  document.getElementById("findings").replaceChildren(...list);
}

async function records() {
  const page = await api("/records?limit=30");
  fill("records", page.items.map((r) => [r.start_utc.slice(0, 16).replace("T", " "), r.duration_s.toFixed(0), r.status.replace("_", " "), r.source_name, r.problem ? r.problem.detail : ""]), [1]);
}

let due = null;
async function refresh() {
  due = null;
  await Promise.allSettled([twin(), modes(), findings(), records()]);
}
const live = document.getElementById("live");
const source = new EventSource("/api/v1/events");
source.onopen = () => { live.textContent = "live"; };
source.onerror = () => { live.textContent = "connection lost, trying again"; };
for (const kind of ["record", "observation", "state", "finding", "asset"])
  source.addEventListener(kind, (event) => { if (JSON.parse(event.data).asset === asset) due = due ?? setTimeout(refresh, 700); });
refresh();
