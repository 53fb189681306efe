"use strict";
const report = JSON.parse(document.getElementById("report-data").textContent);
const pictures = JSON.parse(document.getElementById("picture-data").textContent);
const $ = id => document.getElementById(id);
const MEASURES = {relmse: "relMSE", relmse_trimmed: "trimmed relMSE", rmse: "RMSE", flip: "FLIP"};
const points = report.points;
let chosen = 0, measure = "relmse_trimmed";
let isKept = false; // whether passing over other points leaves the one that is chosen

const digits = value => value >= 100 ? Math.round(value).toString() : Number(value.toPrecision(3)).toString();
const time = ms => ms < 999.5 ? `${digits(ms)} ms` : `${digits(ms / 1000)} s`;
const percent = relmse => `${digits(Number((100 * Math.sqrt(relmse)).toPrecision(2)))} %`;

function element(tag, text, parent) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (parent) parent.append(made);
  return made;
}

function wrong(point) {
  const value = point.error[measure], words = `${MEASURES[measure]} ${digits(value)}`;
  return measure.startsWith("relmse") ? `about ${percent(value)} (${words}, FLIP ${digits(point.error.flip)})` : words;
}

function fillHeader() {
  $("title").textContent = report.scene;
  const [width, height] = report.size;
  $("summary").textContent = `${points.length} ways to show it at ${width} x ${height} on ${report.device}, ` +
      `against ${report.reference.spp} path-traced samples a pixel` + (report.is_whole ? "" : " (interrupted)");
  document.title = `${report.scene}: error against time`;
}

function fillRecommendations() {
  const names = {33: "30 frames a second", 100: "0.1 s", 1000: "1 s", 10000: "10 s"};
  const body = $("recommend").tBodies[0];
  body.replaceChildren();
  for (const row of report.recommend) {
    const index = row.by[measure], line = element("tr", "", body);
    element("td", `${names[Math.round(row.budget_ms)] || time(row.budget_ms)}`, line);
    if (index === null) {
      element("td", "nothing is so fast here", line).colSpan = 4;
      continue;
    }
    const point = points[index];
    element("td", point.label, line);
    element("td", time(point.time_ms.median), line);
    element("td", wrong(point), line);
    const button = element("button", "Show", element("td", "", line));
    button.addEventListener("click", () => { keep(index); $("chosen").scrollIntoView({block: "nearest"}); });
  }
}

function fillTable() {
  const body = $("points").tBodies[0];
  points.forEach((point, index) => {
    const row = element("tr", "", body), t = point.time_ms;
    row.dataset.point = index;
    element("td", point.label, row);
    element("td", time(t.median), row);
    element("td", t.n > 1 ? `${time(t.p10)} to ${time(t.p90)}` : "", row);
    element("td", t.n, row);
    for (const name in MEASURES) element("td", digits(point.error[name]), row);
    row.addEventListener("click", () => keep(index));
  });
}

function fillNotes() {
  for (const [change, knobs] of grouped(report.knobs)) {
    const saved = knobs.map(knob => Math.round(100 * knob.saved));
    const [least, most] = [Math.min(...saved), Math.max(...saved)];
    const range = least === most ? least : `${least} to ${most}`;
    element("li", `${change} saves ${range} % of the time: ${knobs.map(effect).join("; ")}`, $("knobs"));
  }
  if (!report.knobs.length)
    element("li", "Nothing was found: every setting that costs time lowers the error.", $("knobs"));
  const reference = report.reference;
  const how = [
    `Device: ${report.device}, OpenGL ${report.opengl} (${report.backend}); pbr-viewer ${report.version}.`,
    `Scene: ${report.triangles} triangles, environment ${report.environment || "none"}. Errors are over the ` +
        `${report.model_pixels} pixels in which the model is; the background, the same in all, does not count.`,
    `Reference: path traced with ${reference.spp} samples a pixel in two independent halves, ` +
        `${digits(reference.seconds)} s. ` +
        `By how far they are apart, its own noise adds a relMSE of ${digits(reference.relmse_floor)} to every point ` +
        `(without the worst pixels ${digits(reference.floor.relmse_trimmed)}, RMSE ${digits(reference.floor.rmse)}, ` +
        `FLIP ${digits(reference.floor.flip)}). It is not subtracted.`,
    "relMSE is the mean of (x - r)² / (r² + 0.01) over linear radiance, before exposure and tone map; its root is " +
        "about the relative error. A few pixels can be most of it: trimmed, it leaves out the worst 0.1 % of them. " +
        "FLIP is of the pictures as displayed.",
    "A time is the median of the runs after warm-up, by the wall clock, with the device finished; of a raster frame " +
        "with everything prepared, of a path-traced picture from its beginning with the scene prepared.",
    `Preparing, once for a scene: raster ${time(1000 * prepared(false))}, path tracer ${time(1000 * prepared(true))}.`,
    "Pictures in this page are compressed (WebP); figures are from the full ones, beside it in measured/.",
  ];
  for (const line of how) element("li", line, $("how"));
  for (const out of report.left_out) element("li", `${out.method}: ${out.reason}`, $("left-out"));
  if (!report.left_out.length) element("li", "nothing", $("left-out"));
}

function grouped(knobs) {
  const groups = new Map();
  for (const knob of knobs) {
    const change = `${knob.setting.replace("_", "-")} ${knob.values[0]} instead of ${knob.values[1]}`;
    groups.set(change, [...(groups.get(change) || []), knob]);
  }
  return groups;
}

function effect(knob) {
  const [dear, cheap] = [points[knob.dear], points[knob.cheap]];
  const [before, after] = [dear, cheap].map(point => digits(point.error.relmse_trimmed));
  return `${dear.label} (trimmed relMSE ${before}, then ${after})`;
}

function prepared(isTraced) {
  return Math.max(0, ...points.filter(p => (p.settings.mode === "path") === isTraced).map(p => p.prepare_s || 0));
}

function choose(index) {
  chosen = index;
  const point = points[index], t = point.time_ms, error = point.error;
  for (const node of document.querySelectorAll("[data-point]"))
    node.classList.toggle("chosen", Number(node.dataset.point) === index);
  $("label").textContent = point.label;
  $("picture").src = pictures.points[index];
  $("picture").alt = point.label;
  $("map").src = pictures.maps[index];
  const facts = {
    "Time": time(t.median) + (t.n > 1 ? `, 80 % between ${time(t.p10)} and ${time(t.p90)}, ${t.n} runs` : ", one run"),
    "Error": `about ${percent(error.relmse_trimmed)}: relMSE ${digits(error.relmse)}, without the worst 0.1 % of pixels ` +
        `${digits(error.relmse_trimmed)}; RMSE ${digits(error.rmse)}, FLIP ${digits(error.flip)}`,
    "Where": `${Math.round(100 * point.too_bright)} % of relMSE from where it is brighter than the reference`,
    "Settings": Object.entries(point.settings).map(([name, value]) => `${name} ${value}`).join(", "),
  };
  if (point.spp) facts["Samples"] = `${digits(point.spp)} a pixel, ${point.rays} rays`;
  if (point.bad_pixels) facts["Not finite"] = `${point.bad_pixels} pixels, counted as black`;
  $("facts").replaceChildren();
  for (const name in facts) { element("dt", name, $("facts")); element("dd", facts[name], $("facts")); }
  $("command").textContent = point.command;
  $("copy").textContent = "Copy";
}

function keep(index) {
  isKept = !(isKept && chosen === index);
  choose(index);
}

function show(name) {
  measure = name;
  for (const chart of document.querySelectorAll(".chart"))
    chart.classList.toggle("shown", chart.dataset.measure === name);
  for (const row of document.querySelectorAll("#points tbody tr"))
    row.classList.toggle("front", points[row.dataset.point].pareto_by[name]);
  fillRecommendations();
}

function cut(percentage) {
  $("slider").value = percentage;
  $("wipe").style.setProperty("--cut", `${$("slider").value}%`);
}

function step(event) {
  const by = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
  const to = event.key === "Home" ? 0 : event.key === "End" ? points.length - 1 : by && chosen + by;
  if (to === undefined || to < 0 || to >= points.length) return;
  event.preventDefault();
  choose(to);
}

async function copy() {
  const text = $("command").textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch (refused) { // a browser that gives pages from files no clipboard
    const range = document.createRange();
    range.selectNodeContents($("command"));
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand("copy");
  }
  $("copy").textContent = "Copied";
}

function listen() {
  $("measure").addEventListener("change", event => show(event.target.value));
  $("slider").addEventListener("input", event => cut(event.target.value));
  $("copy").addEventListener("click", copy);
  $("charts").addEventListener("keydown", step);
  for (const node of document.querySelectorAll("g.point")) {
    const index = Number(node.dataset.point);
    node.addEventListener("pointerenter", () => { if (!isKept) choose(index); });
    node.addEventListener("click", () => keep(index));
  }
  const drag = event => {
    const box = $("wipe").getBoundingClientRect();
    cut(100 * Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1));
  };
  $("wipe").addEventListener("pointerdown", event => { $("wipe").setPointerCapture(event.pointerId); drag(event); });
  for (const kind of ["pointermove", "pointerup"])
    $("wipe").addEventListener(kind, event => { if ($("wipe").hasPointerCapture(event.pointerId)) drag(event); });
}

fillHeader();
fillTable();
fillNotes();
listen();
$("reference").src = pictures.reference;
show(measure);
const best = report.recommend.map(row => row.point).filter(index => index !== null);
choose(best.length ? best[0] : 0);
cut(50);
