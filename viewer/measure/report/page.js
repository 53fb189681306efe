"use strict";
const report = JSON.parse(document.getElementById("report-data").textContent);
const pictures = JSON.parse(document.getElementById("picture-data").textContent);
const $ = id => document.getElementById(id);
const MEASURES = {relmse_trimmed: "trimmed relMSE", relmse: "relMSE", rmse: "RMSE", flip: "FLIP"};
const OWN_OPTION = ["mode", "denoise"]; // settings that --set does not reach
const HD = [1280, 720];
const points = report.points;
let chosen = 0, measure = "relmse_trimmed";
let isKept = false; // whether the chosen point stays chosen while the pointer moves over others

const digits = (value, count = 2) =>
  value >= 10 ** count ? Math.round(value).toString() : Number(value.toPrecision(count)).toString();
const time = ms => ms < 999.5 ? `${digits(ms, 3)}\u00a0ms` : `${digits(ms / 1000, 3)}\u00a0s`;
const percent = relmse => `${Number((100 * Math.sqrt(relmse)).toPrecision(2))}\u00a0%`;
const size = ([width, height]) => `${width} x ${height}`;
const rate = ms => ms < 200 ? ` (${digits(1000 / ms)} frames a second)` : "";

function element(tag, text, parent) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (parent) parent.append(made);
  return made;
}

function button(text, parent, act) {
  const made = element("button", text, parent);
  made.type = "button";
  made.addEventListener("click", act);
  return made;
}

function commandLine(text, parent) {
  const line = element("div", "", parent), code = element("code", "", line);
  line.className = "command";
  text.split(" ").forEach((word, k) => { if (k) code.append(" "); element("span", word, code); });
  button("Copy", line, event => copy(text, code, event.target));
  return line;
}

async function copy(text, code, said) {
  try {
    await navigator.clipboard.writeText(text);
  } catch (refused) { // a browser that gives pages from files no clipboard
    getSelection().selectAllChildren(code);
    document.execCommand("copy");
  }
  said.textContent = "Copied";
  setTimeout(() => { said.textContent = "Copy"; }, 2000);
}

function tendency(point) {
  if (["path", "path-adaptive"].includes(point.method)) return "which is noise";
  if (point.too_bright > 2 / 3) return "mostly where it is too bright";
  return point.too_bright < 1 / 3 ? "mostly where it is too dark" : "partly too bright and partly too dark";
}

function wrong(point) {
  const {relmse_trimmed: error, flip} = point.error, floor = report.reference.floor.relmse_trimmed;
  const doubt = error < 4 * floor ? ", and much of it is the reference's own noise" : "";
  return `${percent(error)}, ${tendency(point)}${doubt}; FLIP\u00a0${digits(flip)}`;
}

function fillHeader() {
  $("title").textContent = report.scene;
  $("summary").textContent = `${points.length} methods of rendering this model at ${size(report.size)} on ` +
      `${report.device}, compared with a path-traced reference of ${report.reference.spp} samples per pixel` +
      (report.is_whole ? "." : ". The measurement was interrupted.");
  document.title = `${report.scene}: error against time`;
  const more = HD[0] * HD[1] / (report.size[0] * report.size[1]);
  const larger = more < 1.5 ? "" : ` Larger pictures take longer: ${size(HD)} has ${digits(more)} times as many ` +
      `pixels and takes up to ${digits(more)} times as long.`;
  $("scope").textContent = `All times were measured at ${size(report.size)} on ${report.device}` +
      `${report.is_software ? ", which renders on the processor" : ""}.${larger} For other sizes and times, ` +
      `pbr-viewer render MODEL --size WIDTHxHEIGHT --time-budget SECONDS chooses a method.`;
}

function fillRecommendations() {
  const names = {33: "30 frames a second", 100: "a picture in 0.1 s", 1000: "a picture in 1 s",
    10000: "a picture in 10 s"};
  $("recommend").replaceChildren();
  let before = null;
  for (const row of report.recommend) {
    const index = row.by[measure], line = element("div", "", $("recommend"));
    const name = element("dt", names[Math.round(row.budget_ms)], line).textContent;
    const text = element("dd", "", line), sentence = element("p", "", text);
    if (index === null) {
      const fastest = points[0], took = fastest.time_ms.median;
      sentence.textContent = `No method is fast enough. The fastest, ${fastest.label}, takes ` +
          `${time(took)}${rate(took)}.`;
    } else if (before && before.index === index) {
      sentence.textContent = `No better method was measured than ${points[index].label}, as for ${before.name}.`;
    } else {
      tell(index, sentence, text);
      before = {index, name};
    }
  }
}

function tell(index, sentence, text) {
  const point = points[index], took = point.time_ms.median;
  element("b", point.label, sentence);
  const by = measure === "relmse_trimmed" || measure === "flip" ? "" :
      `; ${MEASURES[measure]} ${digits(point.error[measure])}`;
  const first = point.ready_s > took / 1e3 ? ` The first picture takes ${time(1000 * point.ready_s)} more.` : "";
  sentence.append(` takes ${time(took)} per picture${rate(took)}.${first} Its relative error is ` +
      `${wrong(point)}${by}.`);
  const command = commandLine(point.command, text);
  button("Show", command, () => { hold(index); $("charts").scrollIntoView({block: "nearest"}); });
}

function fillQualities() {
  $("qualities").replaceChildren();
  for (const [name, index] of Object.entries(report.qualities)) {
    const line = element("div", "", $("qualities"));
    element("dt", `--quality ${name}`, line);
    const text = element("dd", "", line), sentence = element("p", "", text);
    if (index === null) sentence.textContent = "It was not measured.";
    else tell(index, sentence, text);
  }
}

function fillTable() {
  const body = $("points").tBodies[0];
  points.forEach((point, index) => {
    const row = element("tr", "", body), t = point.time_ms;
    row.dataset.point = index;
    button(point.label, element("td", "", row), () => {});
    element("td", time(t.median), row);
    element("td", t.n > 1 ? `${time(t.p10)} to ${time(t.p90)}` : "", row);
    element("td", t.n, row);
    element("td", percent(point.error.relmse_trimmed), row);
    for (const name in MEASURES) element("td", digits(point.error[name]), row);
    row.addEventListener("click", () => { hold(index); $("charts").scrollIntoView({block: "nearest"}); });
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
    element("li", "None: every setting that costs time reduces the error.", $("knobs"));
  const reference = report.reference, floor = reference.floor;
  const how = [
    `Device: ${report.device}, OpenGL ${report.opengl} (${report.backend}); pbr-viewer ${report.version}.`,
    `Scene: ${report.triangles} triangles, environment ${report.environment || "none"}. Errors are means over the ` +
        `${report.model_pixels} pixels that show the model. The background is the same for all methods and does not ` +
        "count.",
    `Reference: path traced with ${reference.spp} samples per pixel in two independent halves, in ` +
        `${digits(reference.seconds)} s. The difference of the halves shows that the reference itself has a relative ` +
        `error of about ${percent(floor.relmse_trimmed)}. This noise adds a relMSE of ` +
        `${digits(reference.relmse_floor)} (trimmed ${digits(floor.relmse_trimmed)}), an RMSE of ` +
        `${digits(floor.rmse)} and a FLIP of ${digits(floor.flip)} to every measurement. It is not subtracted.`,
    "relMSE is the mean of (x - r)² / (r² + 0.01) over linear radiance, before exposure and tone map. A few pixels " +
        "can dominate it, so the trimmed relMSE leaves out the worst 0.1 % of them. RMSE is in units of radiance. " +
        "FLIP compares the pictures as displayed.",
    "A time is the median of several runs after a warm-up, by the wall clock, until the device has finished. The " +
        "scene is prepared before. A path-traced picture is timed from its first sample to its display.",
    `Preparing the scene takes up to ${time(1000 * prepared(false))} for the raster and up to ` +
        `${time(1000 * prepared(true))} for the path tracer, once.`,
    "The pictures in this page are compressed (WebP). The figures are from the uncompressed pictures in the folder " +
        "measured/ beside this page.",
  ];
  for (const line of how) element("li", line, $("how"));
  $("more-time").textContent = `Measuring took ${digits(report.measured_s)} s. More time (--within SECONDS) gives ` +
      `more points and a better reference.`;
  for (const out of report.left_out) element("li", `${out.method}: ${out.reason}`, $("left-out"));
  if (!report.left_out.length) element("li", "none", $("left-out"));
}

function grouped(knobs) {
  const groups = new Map();
  for (const knob of knobs) {
    const name = knob.setting.replace("_", "-"), [cheap, dear] = knob.values;
    const change = knob.setting === "lights" ? "Using lights instead of the whole environment" :
        `${OWN_OPTION.includes(name) ? `--${name} ` : `--set ${name}=`}${cheap} instead of ${dear}`;
    groups.set(change, [...(groups.get(change) || []), knob]);
  }
  return groups;
}

function effect(knob) {
  const [before, after] = [knob.dear, knob.cheap].map(index => percent(points[index].error.relmse_trimmed));
  return `${points[knob.dear].label} (relative error ${before} before, ${after} after)`;
}

function prepared(isTraced) {
  return Math.max(0, ...points.filter(p => (p.settings.mode === "path") === isTraced).map(p => p.ready_s));
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
    "Time": time(t.median) + (t.n > 1 ? `; 80 % of ${t.n} runs took ${time(t.p10)} to ${time(t.p90)}` : ", one run"),
    "Relative error": wrong(point),
    "Measures": Object.entries(MEASURES).map(([name, title]) => `${title} ${digits(error[name])}`).join(", "),
    "Too bright": `${Math.round(100 * point.too_bright)} % of relMSE comes from pixels brighter than the reference`,
    "Preparing": `about ${time(1000 * point.ready_s)}, once per scene`,
    ...point.quality && {"Quality": point.quality},
    "Settings": Object.entries(point.settings).map(([name, value]) => `${name} ${value}`).join(", "),
  };
  if (point.spp) facts["Samples"] = `${digits(point.spp, 3)} per pixel, ${point.rays} rays`;
  if (point.bad_pixels) facts["Not finite"] = `${point.bad_pixels} pixels, which count as black`;
  $("facts").replaceChildren();
  for (const name in facts) { element("dt", name, $("facts")); element("dd", facts[name], $("facts")); }
  $("command-line").replaceChildren();
  commandLine(point.command, $("command-line"));
}

function hold(index) {
  isKept = index !== null;
  if (isKept) choose(index);
  $("hint").textContent = isKept ? "This point stays selected. Click it again to select others by pointing at them." :
    "Point at a mark to see its picture; click to keep it selected. The arrow keys, Home and End move between marks.";
}

function show(name) {
  measure = name;
  for (const chart of document.querySelectorAll(".chart"))
    chart.classList.toggle("shown", chart.dataset.measure === name);
  for (const row of document.querySelectorAll("#points tbody tr"))
    row.classList.toggle("front", points[row.dataset.point].pareto_by[name]);
  fillRecommendations();
  fillQualities();
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

function listen() {
  $("measure").addEventListener("change", event => show(event.target.value));
  $("slider").addEventListener("input", event => cut(event.target.value));
  $("charts").addEventListener("keydown", step);
  for (const node of document.querySelectorAll("g.point")) {
    const index = Number(node.dataset.point);
    node.addEventListener("pointerenter", () => { if (!isKept) choose(index); });
    node.addEventListener("click", () => hold(isKept && chosen === index ? null : index));
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
hold(null);
const best = report.recommend.map(row => row.point).filter(index => index !== null);
choose(best.length ? best[0] : 0);
cut(50);
