"use strict";
// Plots of curves over time, with the phases behind them and a needle at the time that is shown.

const PHASE_COLORS = { Hold: "#eaeef2", Stance: "#fff1d6", Flight: "#dff0ff", PreLanding: "#e7e3ff", Landing: "#ffe3dc", Stand: "#e3f6e6", Abort: "#ff9d8f" };
/// Height of a run's strip of phases where several share a plot, pixels.
const STRIP = 6;

/// What is drawn of the phases: the whole background of one run, strips on top of each other of several.
function bands(runs) {
  return u => {
    const { ctx, bbox: { left, top, width, height } } = u;
    ctx.save();
    ctx.beginPath(); ctx.rect(left, top, width, height); ctx.clip();
    runs.forEach((run, k) => {
      const [y, high] = runs.length === 1 ? [top, height] : [top + k * STRIP * devicePixelRatio, STRIP * devicePixelRatio];
      for (const [name, from, to] of run.phases) {
        ctx.fillStyle = PHASE_COLORS[name] || "#fff";
        const x = u.valToPos(from - run.zero, "x", true);
        ctx.fillRect(x, y, u.valToPos(to - run.zero, "x", true) - x, high);
      }
    });
    ctx.restore();
  };
}

/// A line at a time.
function needle(time) {
  return u => {
    const x = u.valToPos(time(), "x", true), { left, top, width, height } = u.bbox;
    if (x < left || x > left + width) return;
    u.ctx.save();
    u.ctx.strokeStyle = "#1d2730";
    u.ctx.lineWidth = 1.5;
    u.ctx.setLineDash([]);
    u.ctx.beginPath(); u.ctx.moveTo(x, top); u.ctx.lineTo(x, top + height); u.ctx.stroke();
    u.ctx.restore();
  };
}

/// The curves of a comparison: each measure with a curve per run, and its plan dashed, over the time since the take-off.
function overlaid(runs) {
  return runs[0].measures.map((measure, k) => {
    const tables = runs.map(run => [run.plot_times.map(t => Math.round(1e4 * (t - run.zero)) / 1e4), ...run.measures[k].series.map(s => s.values)]);
    const curves = runs.flatMap(run => run.measures[k].series.map(s => ({ ...s, color: run.color, label: s.dashed ? `${run.label} ${s.label}` : run.label })));
    return { title: measure.title, unit: measure.unit, series: curves, table: uPlot.join(tables) };
  });
}

/// Draws all plots into `host`; a click asks for a time.
function drawPlots(host, plots, runs, time, ask) {
  const width = place => Math.max(260, place.clientWidth - 12), height = 230;
  const made = plots.map(plot => {
    const place = document.createElement("div");
    place.className = "plot";
    host.append(place);
    const text = (x, unit) => x == null ? "" : x.toFixed(3) + unit;
    const curves = plot.series.map(s => ({ label: s.label, stroke: s.color, width: 1.4, dash: s.dashed ? [6, 4] : undefined, value: (u, v) => text(v, "") }));
    const u = new uPlot({
      title: plot.title, width: width(place), height,
      scales: { x: { time: false } }, axes: [{ label: runs.length > 1 ? "time since the take-off, s" : "time, s", labelSize: 18 }, { label: plot.unit, labelSize: 18, size: 56 }],
      series: [{ label: "t", value: (u, v) => text(v, " s") }, ...curves],
      cursor: { sync: { key: "saltus" } }, hooks: { drawClear: [bands(runs)], draw: [needle(time)] },
    }, plot.table, place);
    u.over.addEventListener("click", e => ask(u.posToVal(e.offsetX, "x")));
    return u;
  });
  window.addEventListener("resize", () => made.forEach(u => u.setSize({ width: width(u.root.parentElement), height })));
  return made;
}
