"use strict";
// The pictures stand in a grid: columns go around the model, rows from the lowest elevation to the highest.
const { columns, rows, column, row, azimuth, elevations, pictures } =
  JSON.parse(document.getElementById("pictures").textContent);
const model = document.getElementById("model"), picture = document.getElementById("picture");
const loaded = pictures.map((source) => Object.assign(new Image(), { src: source }));  // so that none is late
let x = column, y = row, last = null;  // fractions of a column and a row add up while the mouse moves

function show() {
  y = Math.min(Math.max(y, 0), rows - 1);
  const across = ((Math.round(x) % columns) + columns) % columns, up = Math.round(y);
  picture.src = loaded[up * columns + across].src;
  const degrees = Math.round(((((azimuth + (360 * across) / columns) % 360) + 360) % 360) * 10) / 10;
  const from = `Azimuth ${degrees}°, elevation ${Math.round(elevations[up] * 10) / 10}°`;
  model.setAttribute("aria-valuenow", across);
  model.setAttribute("aria-valuetext", from);
  document.getElementById("from").textContent = from;
}

model.addEventListener("pointerdown", (event) => {
  if (event.button !== 0 || last) return;
  last = event;
  model.setPointerCapture(event.pointerId);
  model.classList.add("held");
});
model.addEventListener("pointermove", (event) => {
  if (!last || event.pointerId !== last.pointerId) return;
  // As in the window: half a turn for a height of the picture, and the model follows the hand.
  const height = picture.clientHeight || 1;
  x -= ((event.clientX - last.clientX) / height) * (columns / 2);
  if (rows > 1) y += ((event.clientY - last.clientY) / height) * (180 / (elevations[1] - elevations[0]));
  last = event;
  show();
});
for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
  model.addEventListener(kind, (event) => {
    if (!last || event.pointerId !== last.pointerId) return;
    last = null;
    model.classList.remove("held");
  });
}
model.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  if (steps) [x, y] = [Math.round(x) + steps[0], Math.round(y) + steps[1]];
  else if (event.key === "Home") [x, y] = [column, row];
  else return;
  event.preventDefault();
  show();
});
model.addEventListener("dragstart", (event) => event.preventDefault());

model.tabIndex = 0;
model.setAttribute("role", "slider");
model.setAttribute("aria-valuemin", 0);
model.setAttribute("aria-valuemax", columns - 1);
model.classList.toggle("tilts", rows > 1);
document.getElementById("how").textContent = rows > 1
  ? "Drag to turn and to tilt, or use the arrow keys." : "Drag to turn, or use the arrow keys.";
show();
