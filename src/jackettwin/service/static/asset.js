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
// side_side_1: side-side 1, as in the report
const words = (label) => label.replace(/_(\d+)$/, " $1").replaceAll("_", "-");

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
  fill("supports", Object.values(supports).map((p) => [p.words, p.text, p.day ?? "all records"]), []);
  document.getElementById("now").textContent = known.parameters.statement ?? "";
  const percent = (v) => !v ? null : `${(100 * v.value).toFixed(2)}${v.low === null ? "" : ` (${(100 * v.low).toFixed(2)} to ${(100 * v.high).toFixed(2)})`}`;
  fill("budget", (known.parameters.budget || []).map((m) => [words(m.label), percent(m.measured),
    ...["structure", "soil", "rotor", "water"].map((source) => percent(m.sources[source])),
    m.unexplained ? (100 * m.unexplained).toFixed(2) : null]), [1, 2, 3, 4, 5, 6]);
  report(known.parameters.law && `${known.version} ${known.parameters.until_utc} ${known.parameters.records}`, known.version);
  document.getElementById("law").textContent = known.parameters.law
    ? `Law ${known.parameters.law}. All records: the ${counted(known.parameters.records, "record")} up to ${known.parameters.until_utc.slice(0, 10)} together, as if the ground had been the same; posterior: ${known.parameters.status}.`
    : "Not estimated yet: this is done when no record waits.";
  document.getElementById("sentence").textContent = known.records
    ? `${counted(known.records, "record")} of ${counted(known.days, "day")}, ${known.first_utc.slice(0, 16).replace("T", " ")} to ${known.last_utc.slice(0, 16).replace("T", " ")} UTC. ${known.status}`
    : "No record has been observed yet.";
}

// The stiffness of each day over that of the first.
async function stiffness() {
  const found = await api("/supports"), part = document.getElementById("through");
  const known = found.days.filter((day) => day.relative_stiffness), time = found.stiffness_in_time;
  part.hidden = !time || !known.length;
  if (part.hidden) return;
  const middle = (spans) => spans.map((s) => s.median), noon = (date) => `${date}T12:00:00Z`;
  const band = (x, spans, colour, name, dash) => [
    { x: [...x, ...x.slice().reverse()], y: [...spans.map((s) => s.interval_90[1]), ...spans.map((s) => s.interval_90[0]).reverse()], fill: "toself",
      fillcolor: `${colour}33`, mode: "lines", line: { width: 0 }, hoverinfo: "skip", showlegend: false },
    { x, y: middle(spans), mode: "lines", line: { color: colour, width: 2, dash }, name }];
  const then = known.map((day) => day.relative_stiffness), last = known[0];
  const later = (days) => new Date(Date.parse(last.time_utc) + days * 864e5).toISOString();
  const traces = [
    { x: known.map((day) => day.time_utc), y: middle(then), mode: "markers", marker: { size: 4, color: "#7f7f7f" }, name: "known on the day",
      error_y: { type: "data", symmetric: false, thickness: 0.6, width: 0, array: then.map((s) => s.interval_90[1] - s.median), arrayminus: then.map((s) => s.median - s.interval_90[0]) } },
    ...band(Object.keys(time.smoothed).map(noon), Object.values(time.smoothed), COLOURS[0], "by all days", "solid"),
    ...band([last.time_utc, ...time.forecast.map((f) => later(f.days))], [last.relative_stiffness, ...time.forecast], "#7f7f7f", "expected", "dot")];
  const shapes = time.changes.map((c) => ({ type: "line", x0: c.time_utc, x1: c.time_utc, yref: "paper", y0: 0, y1: 1, line: { color: COLOURS[1], width: 1 } }));
  const from = Date.parse(known.at(-1).time_utc), seen = (Date.parse(last.time_utc) - from) / 864e5;
  const layout = plain("stiffness over the first day's", "linear");
  layout.xaxis.range = [known.at(-1).time_utc, later(Math.max(time.forecast[0].days, Math.min(seen, 365)))];
  Plotly.react("stiffness", traces, { ...layout, shapes }, CONFIG);
  const cells = (span) => span ? [span.median.toFixed(3), span.interval_90.map((v) => v.toFixed(3)).join(" to ")] : [null, null];
  fill("days", known.slice(0, 14).map((day) => [day.time_utc.slice(0, 10), ...cells(day.relative_stiffness), ...cells(time.smoothed[day.time_utc.slice(0, 10)])]), [1, 2, 3, 4]);
}

const plain = (title, type) => ({
  margin: { l: 60, r: 10, t: 10, b: 40 }, yaxis: { title: { text: title }, type }, xaxis: { title: { text: "UTC" }, type: "date" },
  legend: { orientation: "h", y: 1.15 }, font: { family: "system-ui, sans-serif", size: 13 },
});
const CONFIG = { displaylogo: false, responsive: true };

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
  Plotly.react("frequency", labels.map((l, i) => trace(l, i, (m) => m.frequency_hz, (own) => ({ array: own.map((m) => m.frequency_std_hz) }))), plain("frequency [Hz]", "log"), CONFIG);
  Plotly.react("damping", labels.map((l, i) => trace(l, i, (m) => m.damping_ratio === null ? null : 100 * m.damping_ratio, (own) => ({
    array: own.map((m) => m.damping_ratio_interval_95 ? 100 * (m.damping_ratio_interval_95[1] - m.damping_ratio) : 0),
    arrayminus: own.map((m) => m.damping_ratio_interval_95 ? 100 * (m.damping_ratio - m.damping_ratio_interval_95[0]) : 0), symmetric: false,
  }))), plain("damping ratio [%]", "log"), CONFIG);
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
  await Promise.allSettled([twin(), stiffness(), modes(), findings(), records()]);
}
const live = document.getElementById("live");
const source = new EventSource("/api/v1/events");
source.onopen = () => { live.textContent = "live"; };
source.onerror = () => { live.textContent = "connection lost, trying again"; };
for (const kind of ["record", "observation", "state", "finding", "asset"])
  source.addEventListener(kind, (event) => { if (JSON.parse(event.data).asset === asset) due = due ?? setTimeout(refresh, 700); });
refresh();
