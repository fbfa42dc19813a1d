"use strict";
// The page of one run, or of several side by side on one clock, which is zero at each one's planned take-off.

const byId = id => document.getElementById(id);
const DATA = JSON.parse(byId("data").textContent), RUNS = DATA.runs, many = RUNS.length > 1;
const RUN_COLORS = ["#0969da", "#bc4c00", "#1a7f37", "#8250df", "#bf3989", "#7d4e00"];
const make = (parent, tag, text, kind) => {
  const made = document.createElement(tag);
  made.textContent = text;
  if (kind) made.className = kind;
  parent.append(made);
  return made;
};

RUNS.forEach((run, k) => {
  run.zero = many ? run.takeoff : 0;
  run.color = RUN_COLORS[k % RUN_COLORS.length];
  const own = many ? run.color : null;
  if (run.verdict) {
    const line = make(byId("verdicts"), "p", "", `verdict ${run.verdict.mark || ""}`);
    if (many) make(line, "b", `${run.label}: `).style.color = own;
    line.append(run.verdict.words);
  }
  run.stage = new Stage(run, own);
  run.pane = make(byId("panes"), "div", "", "pane");
  const badge = make(make(run.pane, "div", "", "badge"), "span", "");
  if (many) make(badge, "b", `${run.label} `).style.color = own;
  run.badge = make(badge, "span", "");
});

// Tables: the result of one run, or what differs between several; what is long stays folded.
const isPlant = row => row[0].startsWith("plant: ");
if (many) {
  byId("more").hidden = !DATA.differences.some(isPlant);
  byId("more").open = DATA.differences.filter(isPlant).length <= 6;
  for (const id of ["table", "plant"]) {
    const head = byId(id).insertRow();
    make(head, "th", "");
    RUNS.forEach(run => { make(head, "th", run.label).style.color = run.color; });
  }
}
for (const line of many ? DATA.differences : RUNS[0].table) {
  const [name, ...cells] = line, mark = many ? null : cells.pop();
  const row = byId(many && isPlant(line) ? "plant" : "table").insertRow();
  make(row, "td", many ? name.replace("plant: ", "") : name);
  cells.forEach(cell => make(row, "td", cell, mark));
}
byId("legend").textContent = "Arrows are the forces of the ground, 15 cm for the robot's weight; red is the centre of mass with its path, "
  + (RUNS[0].plan.origins ? "the blue ghost the plan, up to its touchdown" : "blue its plan, up to the touchdown") + "; the green disc is the goal.";
byId("plots-legend").textContent = many
  ? "A colour per run; dashed lines are the plan, strips on top the phases. Drag to zoom, double-click to zoom out, click to move the animation there."
  : "Shaded bands are the phases; dashed lines are the plan or the limits. Drag to zoom, double-click to zoom out, click to move the animation there.";

// One renderer for all panes, and one camera: every pane is seen from the same side. Each scene's origin is what is looked at.
const view = byId("view");
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.shadowMap.enabled = true;
renderer.setScissorTest(true);
view.prepend(renderer.domElement);
const camera = new THREE.PerspectiveCamera(34, 1, 0.05, 60);
camera.up.set(0, 0, 1);
const far = Math.max(...RUNS.map(run => run.stage.extent)) * 2.5;
camera.position.set(0.77 * far, -0.6 * far, 0.3 * far);
const controls = new THREE.OrbitControls(camera, view);
let dirty = true;
controls.addEventListener("change", () => { dirty = true; });
function resize() {
  const wide = view.clientWidth, columns = Math.min(RUNS.length, Math.max(1, Math.floor(wide / 340)), RUNS.length === 4 ? 2 : 3);
  byId("panes").style.gridTemplateColumns = `repeat(${columns}, 1fr)`;
  // As high as leaves the buttons in sight, as far as that can be.
  const rows = Math.ceil(RUNS.length / columns), room = window.innerHeight - (window.scrollY + view.getBoundingClientRect().top) - 60;
  const high = many ? Math.min(340, Math.max(220, room / rows)) : 440;
  RUNS.forEach(run => { run.pane.style.height = `${Math.round(high)}px`; });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.setSize(wide, byId("panes").clientHeight);
  dirty = true;
}
window.addEventListener("resize", resize);
resize();
/// Draws a run in its pane.
function draw(run) {
  const whole = view.getBoundingClientRect(), box = run.pane.getBoundingClientRect();
  const [x, y] = [box.left - whole.left - view.clientLeft, whole.bottom - view.clientTop - box.bottom];
  renderer.setViewport(x, y, box.width, box.height);
  renderer.setScissor(x, y, box.width, box.height);
  camera.aspect = box.width / box.height;
  camera.updateProjectionMatrix();
  renderer.render(run.stage.scene, camera);
}

// The clock.
const begin = Math.min(...RUNS.map(run => run.frames.t[0] - run.zero));
const end = Math.max(...RUNS.map(run => run.frames.t[run.frames.t.length - 1] - run.zero));
let now = Math.max(begin, many ? -0.6 : -0.1), playing = true;
// report.html#t=0.35 opens at that time and waits.
const asked = /^#t=(-?[\d.]+)$/.exec(location.hash);
if (asked) { now = Math.min(end, Math.max(begin, +asked[1])); playing = false; }
const scrub = byId("scrub");
scrub.min = begin; scrub.max = end;
const label = () => { byId("play").textContent = playing ? "Pause" : "Play"; };
const seek = t => { now = t; dirty = true; };
scrub.addEventListener("input", () => { seek(+scrub.value); playing = false; label(); });
byId("play").addEventListener("click", () => { playing = !playing; label(); });
["forces", "plan", "follow"].forEach(id => byId(id).addEventListener("change", () => { dirty = true; }));
label();

const plots = drawPlots(byId("plots"), many ? overlaid(RUNS) : RUNS[0].plots.map(plot => ({ ...plot, table: [RUNS[0].plot_times, ...plot.series.map(s => s.values)] })),
  RUNS, () => now, seek);

function show() {
  const options = { forces: byId("forces").checked, plan: byId("plan").checked, follow: byId("follow").checked };
  for (const run of RUNS) {
    const t = now + run.zero, phase = run.stage.show(t, options);
    run.badge.textContent = `${(Math.round(now * 1000) / 1000 + 0).toFixed(3)} s · ${phase}`;
  }
  scrub.value = now;
}
let before, drawn = NaN;
function tick(stamp) {
  const dt = before === undefined ? 0 : Math.min(0.1, (stamp - before) / 1000);
  before = stamp;
  if (playing) { seek(now + dt * +byId("speed").value); if (now > end) now = begin; }
  controls.update();
  // Nothing is drawn anew while nothing changes.
  if (dirty) { dirty = false; show(); RUNS.forEach(draw); }
  if (Math.abs(now - drawn) > 0.004) { plots.forEach(u => u.redraw(false, false)); drawn = now; }
  requestAnimationFrame(tick);
}
requestAnimationFrame(tick);

// For checks: where the panes are, how deep each run ever is under its ground, and a look along the floor, where every pixel in the
// lower half of a pane is of something under it.
window.SALTUS = {
  runs: RUNS,
  panes: () => RUNS.map(run => { const { left, top, right, bottom } = run.pane.getBoundingClientRect(); return [left, top, right, bottom].map(Math.round); }),
  depths: () => RUNS.map(run => {
    const worst = { depth: -Infinity, time: NaN };
    for (const t of run.frames.t) {
      run.stage.show(t, {});
      const depth = run.stage.depth();
      if (depth > worst.depth) Object.assign(worst, { depth, time: t });
    }
    dirty = true;
    return worst;
  }),
  /// Looks at every run from so far under its floor, at a time of its own as a share of it, and draws it.
  alongFloor: (share, below) => {
    const kept = [camera.position.clone(), camera.quaternion.clone()];
    for (const run of RUNS) {
      const times = run.frames.t, t = times[Math.round(share * (times.length - 1))], stage = run.stage;
      stage.bare(true);
      stage.show(t, { follow: true });
      const height = run.scene.floor + stage.moved(t) - below + stage.world.position.z;
      camera.position.set(far, 0, height);
      camera.lookAt(0, 0, height);
      draw(run);
      stage.bare(false);
    }
    camera.position.copy(kept[0]);
    camera.quaternion.copy(kept[1]);
    // It stays until something changes.
    dirty = false;
  },
};
