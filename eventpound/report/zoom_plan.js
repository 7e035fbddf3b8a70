// Of decks in plan: the bridge from above at one time, which the pointer over a panel or "play" sets.
const plan = run.plan, canvas = document.getElementById("plan");
let now = t[0], playing = null;
const lineOf = (panel, name) => run.panels.find(p => p.name === panel).lines.find(l => l.name === name).y;
const moves = plan.decks.map(deck => ["along", "across", "rotation"].map(word => lineOf(word, deck.name)));
// An impact is seen for so long (s).
const FLASH = 0.15;

function valueAt(y) {
  const i = Math.min(Math.max(first(now), 1), t.length - 1), long = t[i] - t[i - 1];
  return long > 0 ? y[i - 1] + (y[i] - y[i - 1]) * Math.min((now - t[i - 1]) / long, 1) : y[i];
}

function drawPlan() {
  const [pen, wide, high] = surface(canvas), [x0, y0, long, across] = plan.box;
  const scale = Math.min(wide / long, high / across);
  const at = ([x, y]) => [wide / 2 + (x - x0 - long / 2) * scale, high / 2 - (y - y0 - across / 2) * scale];
  const states = moves.map(each => each.map(valueAt));
  const place = (k, [x, y], times) => {
    const [u, v, turn] = states[k], [X, Y] = plan.decks[k].centre;
    return at([X + x + times * (plan.size * u - turn * y), Y + y + times * (plan.size * v + turn * x)]);
  };
  const outline = points => { pen.beginPath(); points.forEach(p => pen.lineTo(...p)); pen.closePath(); };
  plan.decks.forEach((deck, k) => {
    pen.strokeStyle = "#aaa"; pen.setLineDash([4, 3]); outline(deck.corners.map(c => place(k, c, 0))); pen.stroke(); pen.setLineDash([]);
    const hue = run.panels.find(p => p.name === "along").lines.find(l => l.name === deck.name).hue;
    pen.strokeStyle = pen.fillStyle = color(hue); outline(deck.corners.map(c => place(k, c, plan.times)));
    pen.globalAlpha = 0.15; pen.fill(); pen.globalAlpha = 1; pen.lineWidth = 1.5; pen.stroke(); pen.lineWidth = 1;
    pen.fillStyle = "#333"; pen.textAlign = "center"; pen.textBaseline = "middle";
    pen.fillText(`${deck.name}: ${(1e3 * states[k][2]).toFixed(2)} mrad`, ...place(k, [0, 0], plan.times));
  });
  for (const contact of plan.contacts) {
    if (contact.wall) { pen.strokeStyle = "#333"; pen.lineWidth = 3; pen.beginPath(); contact.wall.forEach(p => pen.lineTo(...at(p))); pen.stroke(); pen.lineWidth = 1; }
    const places = contact.at.map(([k, x, y]) => place(k, [x, y], plan.times));
    const [x, y] = [0, 1].map(i => places.reduce((sum, p) => sum + p[i], 0) / places.length);
    const last = run.events.filter(e => e.contact === contact.name && e.struck && e.t <= now && now - e.t < FLASH).pop();
    pen.fillStyle = last ? "#c00" : "#2a8a5f";
    pen.globalAlpha = last ? 1 - 0.7 * (now - last.t) / FLASH : 1;
    pen.beginPath(); pen.arc(x, y, last ? 11 : 3, 0, 7); pen.fill(); pen.globalAlpha = 1;
  }
  document.getElementById("now").textContent =
    `t = ${now.toFixed(3)} s; displacements, rotations and gaps drawn ${plan.times} times larger; red: an impact`;
}

function setNow(time) {
  now = Math.min(Math.max(time, t[0]), t[t.length - 1]);
  drawPlan();
}

const button = document.getElementById("play");
function stop() { cancelAnimationFrame(playing); playing = null; button.textContent = "play"; }
button.onclick = () => {
  if (playing !== null) return stop();
  button.textContent = "stop";
  if (now >= range[1] || now < range[0]) now = range[0];
  let last = null;
  const step = clock => {
    const passed = last === null ? 0 : (clock - last) / 1e3;
    last = clock;
    setNow(now + passed * Number(document.getElementById("speed").value));
    if (now < range[1]) playing = requestAnimationFrame(step); else stop();
  };
  playing = requestAnimationFrame(step);
};
for (const panel of panels) panel.canvas.addEventListener("pointermove", event => {
  if (!event.buttons && playing === null) setNow(timeAt(panel.canvas, event));
});
document.addEventListener("chosen", event => setNow(event.detail));
window.addEventListener("resize", drawPlan);
const begins = chosen !== null ? run.events[chosen].t : Number(asked.get("now") ?? t[0]);
setNow(begins);
