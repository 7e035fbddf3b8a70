"use strict";
// One run: panels over time that share their stretch, loops of that stretch, events to click.
const run = JSON.parse(document.getElementById("run").textContent);
const t = run.t, whole = [t[0], t[t.length - 1]];
let range = [...whole], chosen = null;
const color = i => run.colors[i % run.colors.length];
const dots = window.devicePixelRatio || 1, left = 70, below = 22, above = 8;

function first(x) {
  let low = 0, high = t.length;
  while (low < high) { const m = (low + high) >> 1; if (t[m] < x) low = m + 1; else high = m; }
  return low;
}

function rows() { return [Math.max(first(range[0]) - 1, 0), Math.min(first(range[1]) + 1, t.length)]; }

function ends(lines, from, to) {
  let low = Infinity, high = -Infinity;
  for (const y of lines) for (let i = from; i < to; i++) {
    if (y[i] < low) low = y[i];
    if (y[i] > high) high = y[i];
  }
  if (!(low <= high)) return [-1, 1];
  const margin = 0.06 * (high - low) || Math.abs(high) || 1;
  return [low - margin, high + margin];
}

function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(k => k * power >= raw);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return found.map(x => [x, x.toFixed(Math.min(digits, 12))]);
}

function surface(canvas) {
  const box = canvas.getBoundingClientRect();
  canvas.width = box.width * dots; canvas.height = box.height * dots;
  const pen = canvas.getContext("2d");
  pen.scale(dots, dots);
  pen.font = "11px sans-serif";
  return [pen, box.width, box.height];
}

function frame(pen, wide, high, x, y, name) {
  const X = v => left + (v - x[0]) / (x[1] - x[0]) * (wide - left - 8);
  const Y = v => high - below - (v - y[0]) / (y[1] - y[0]) * (high - below - above);
  pen.strokeStyle = "#e2e2e2"; pen.fillStyle = "#333"; pen.lineWidth = 1;
  pen.textAlign = "center"; pen.textBaseline = "top";
  for (const [v, text] of ticks(x[0], x[1], wide / 90)) {
    pen.beginPath(); pen.moveTo(X(v), above); pen.lineTo(X(v), high - below); pen.stroke();
    pen.fillText(text, X(v), high - below + 4);
  }
  pen.textAlign = "right"; pen.textBaseline = "middle";
  for (const [v, text] of ticks(y[0], y[1], high / 45)) {
    pen.beginPath(); pen.moveTo(left, Y(v)); pen.lineTo(wide - 8, Y(v)); pen.stroke();
    pen.fillText(text, left - 5, Y(v));
  }
  pen.save(); pen.translate(11, high / 2); pen.rotate(-Math.PI / 2); pen.textAlign = "center";
  pen.fillText(name, 0, 0); pen.restore();
  pen.save(); pen.beginPath(); pen.rect(left, above, wide - left - 8, high - below - above); pen.clip();
  return [X, Y];
}

// Over a pixel the least and the greatest value are drawn: no peak is lost.
function line(pen, X, Y, y, from, to) {
  pen.beginPath();
  let column = null, low = 0, high = 0, last = 0;
  for (let i = from; i < to; i++) {
    const at = Math.round(X(t[i]) * dots);
    if (at !== column) {
      if (column !== null) { pen.lineTo(column / dots, Y(low)); pen.lineTo(column / dots, Y(high)); pen.lineTo(column / dots, Y(last)); }
      column = at; low = high = y[i];
      if (i === from) pen.moveTo(X(t[i]), Y(y[i])); else pen.lineTo(X(t[i]), Y(y[i]));
    }
    low = Math.min(low, y[i]); high = Math.max(high, y[i]); last = y[i];
  }
  if (column !== null) { pen.lineTo(column / dots, Y(low)); pen.lineTo(column / dots, Y(high)); pen.lineTo(column / dots, Y(last)); }
  pen.stroke();
}

const panels = run.panels.map(panel => ({...panel, hidden: new Set()}));

function drawPanel(panel) {
  const [pen, wide, high] = surface(panel.canvas), [from, to] = rows();
  const shown = panel.lines.filter((_, i) => !panel.hidden.has(i));
  const y = ends(shown.map(each => each.y), from, to);
  const [X, Y] = frame(pen, wide, high, range, y, `${panel.name} (${panel.unit})`);
  for (const [at, name] of run.shocks) {
    pen.strokeStyle = "#888"; pen.setLineDash([2, 3]);
    pen.beginPath(); pen.moveTo(X(at), above); pen.lineTo(X(at), high); pen.stroke(); pen.setLineDash([]);
    if (panel === panels[0]) { pen.textAlign = "left"; pen.textBaseline = "top"; pen.fillText(name, X(at) + 3, above + 2); }
  }
  pen.lineWidth = 1.2;
  panel.lines.forEach((each, i) => {
    if (panel.hidden.has(i)) return;
    pen.strokeStyle = color(each.hue);
    line(pen, X, Y, each.y, from, to);
    if (panel.marks) run.events.forEach((event, k) => {
      if (event.contact !== each.name || event.t < range[0] || event.t > range[1]) return;
      pen.beginPath(); pen.arc(X(event.t), Y(0), 3.5, 0, 7);
      pen.fillStyle = event.struck ? "#fff" : color(each.hue); pen.fill(); pen.stroke();
      panel.hits.push([X(event.t), Y(0), k]);
    });
  });
  if (chosen !== null) {
    pen.strokeStyle = "#c00"; pen.beginPath();
    pen.moveTo(X(run.events[chosen].t), above); pen.lineTo(X(run.events[chosen].t), high - below); pen.stroke();
  }
  pen.restore();
}

function drawLoop(loop) {
  const [pen, wide, high] = surface(loop.canvas), [from, to] = rows();
  const x = ends([loop.x], from, to), y = ends([loop.y], from, to);
  const [X, Y] = frame(pen, wide, high, x, y, `${loop.name}: force (${run.force})`);
  pen.strokeStyle = color(0); pen.beginPath();
  for (let i = from; i < to; i++) pen.lineTo(X(loop.x[i]), Y(loop.y[i]));
  pen.stroke();
  if (chosen !== null) {
    const i = Math.min(first(run.events[chosen].t), t.length - 1);
    pen.fillStyle = "#c00"; pen.beginPath(); pen.arc(X(loop.x[i]), Y(loop.y[i]), 4, 0, 7); pen.fill();
  }
  pen.restore();
}

function draw() {
  for (const panel of panels) { panel.hits = []; drawPanel(panel); }
  run.loops.forEach(drawLoop);
  document.getElementById("range").textContent = `${range[0].toFixed(4)} to ${range[1].toFixed(4)} s`;
  document.querySelectorAll("#events tr[data-event]").forEach(row =>
    row.classList.toggle("chosen", Number(row.dataset.event) === chosen));
}

function show(low, high) {
  const least = 1e-6 * (whole[1] - whole[0]), long = Math.min(Math.max(high - low, least), whole[1] - whole[0]);
  low = Math.min(Math.max(low, whole[0]), whole[1] - long);
  range = [low, low + long];
  requestAnimationFrame(draw);
}

function choose(k, near) {
  chosen = k;
  const event = run.events[k], half = near ? 0.25 : (range[1] - range[0]) / 2;
  document.getElementById("said").textContent = event.said;
  document.dispatchEvent(new CustomEvent("chosen", {detail: event.t}));
  if (near || event.t < range[0] || event.t > range[1]) show(event.t - half, event.t + half); else draw();
}

function timeAt(canvas, event) {
  const box = canvas.getBoundingClientRect();
  return range[0] + (event.clientX - box.left - left) / (box.width - left - 8) * (range[1] - range[0]);
}

const main = document.getElementById("panels");
for (const panel of panels) {
  const box = document.createElement("div"), names = document.createElement("p");
  panel.canvas = document.createElement("canvas");
  panel.lines.forEach((each, i) => {
    const label = document.createElement("label"), tick = document.createElement("input");
    tick.type = "checkbox"; tick.checked = true;
    tick.onchange = () => { if (tick.checked) panel.hidden.delete(i); else panel.hidden.add(i); draw(); };
    label.style.color = color(each.hue); label.append(tick, each.name); names.append(label);
  });
  box.append(names, panel.canvas); main.append(box);
  let from = null;
  panel.canvas.addEventListener("wheel", event => {
    event.preventDefault();
    const at = timeAt(panel.canvas, event), part = Math.exp(event.deltaY / 400);
    show(at - (at - range[0]) * part, at + (range[1] - at) * part);
  }, {passive: false});
  panel.canvas.onpointerdown = event => { from = [event.clientX, ...range, false]; panel.canvas.setPointerCapture(event.pointerId); };
  panel.canvas.onpointermove = event => {
    if (from === null) return;
    const moved = event.clientX - from[0], long = from[2] - from[1];
    from[3] = from[3] || Math.abs(moved) > 3;
    const by = moved / (panel.canvas.getBoundingClientRect().width - left - 8) * long;
    if (from[3]) show(from[1] - by, from[2] - by);
  };
  panel.canvas.onpointerup = event => {
    if (from !== null && !from[3]) {
      const box = panel.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
      const hit = panel.hits.find(([X, Y]) => Math.hypot(X - x, Y - y) < 8);
      if (hit) choose(hit[2], false);
    }
    from = null;
  };
  panel.canvas.ondblclick = () => show(...whole);
}
const loops = document.getElementById("loops");
for (const loop of run.loops) {
  const box = document.createElement("div"), name = document.createElement("p");
  loop.canvas = document.createElement("canvas");
  name.textContent = `deformation (${run.length})`;
  box.append(loop.canvas, name); loops.append(box);
}
document.getElementById("all").onclick = () => { chosen = null; document.getElementById("said").textContent = ""; show(...whole); };
document.querySelectorAll("#events tr[data-event]").forEach(row => { row.onclick = () => choose(Number(row.dataset.event), true); });
window.addEventListener("resize", draw);
// #event=3 or #t=2,5 of the address begin there.
const asked = new URLSearchParams(location.hash.slice(1));
draw();
if (asked.has("event") && run.events[Number(asked.get("event"))]) choose(Number(asked.get("event")), true);
if (asked.has("t")) show(...asked.get("t").split(",").map(Number));
