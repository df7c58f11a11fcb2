// The page: margin curve, transport and everything that moves the replay. All of it hangs on `showFrame`.
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const times = decode(data.times, Float64Array), clearances = decode(data.clearances, Float64Array);
  const n = times.length, byId = (id) => document.getElementById(id);
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const palette = () => data.statuses.map((status) => css(`--${status}`));
  let colours = palette();
  let frame = 0, playing = null, replay = null, chosen = null; // chosen: the place of a pair in data.pairs

  // Rounded down, as in the tables: what is shown is never more than what was measured.
  function mm(metres) {
    if (metres === 0) return "0";
    if (metres > 0 && metres < 1e-6) return "< 0.001";
    const value = metres * 1000;
    const decimals = Math.max(0, Math.min(3, 3 - Math.floor(Math.log10(Math.abs(value)))));
    const scaled = Math.floor(Number((value * 10 ** decimals).toPrecision(15)));
    return (scaled / 10 ** decimals).toFixed(decimals);
  }

  // Where no pair is left to measure, no bound holds: it is infinite.
  const finite = clearances.filter(Number.isFinite);
  const measured = (i) => !Number.isFinite(clearances[i]) ? "nothing measured" : `${data.known[i] ? "" : "at least "}${mm(clearances[i])} mm`;
  const between = (i) => !Number.isFinite(clearances[i]) ? "no pair is left" : !data.known[i] ? "not measured further" : data.nearest[i].map((k) => (k < 0 ? "–" : data.bodies[k].name)).join(" – ");
  const wordOf = (code) => ({clear: "clear", near: "near miss", violated: "violated", contact: "contact"})[data.statuses[code]];
  const word = (i) => wordOf(data.status[i]);
  const nameOf = (pair) => pair.bodies.map((k) => data.bodies[k].name).join(" – ");

  function frameOfStep(step) {
    let low = 0, high = n - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (data.steps[middle] < step) low = middle + 1; else high = middle;
    }
    return low > 0 && step - data.steps[low - 1] < data.steps[low] - step ? low - 1 : low;
  }

  function frameOfTime(time) {
    let best = 0;
    for (let i = 1; i < n; i++) if (Math.abs(times[i] - time) < Math.abs(times[best] - time)) best = i;
    return best;
  }

  const shown = (k) => k.toLocaleString("en");
  const betweenSteps = (step) => `between the steps ${shown(step)} and ${shown(step + 1)}`;
  const stepText = (i) => data.between[i] ? betweenSteps(data.steps[i]) : `step ${shown(data.steps[i])}`;

  // The rules: with one, nothing is said of it; with several, each frame names its own.
  const several = data.rules.length > 1 || data.rules[0].name !== data.default_rule;
  const ruleText = (name) => !several ? "" : name === data.default_rule ? "by the default limits" : `by rule ${name}`;
  const ruleOf = (i) => data.rules[data.rule[i]];

  // Who has what in hand at a frame, and when the second body of the line is there, if its clock is another.
  const inHand = (i) => data.carries.filter((one) => one.start <= times[i] && (times[i] < one.end || times[i] === one.end && i === n - 1));
  const otherTime = (i) => data.times_b[i] === null ? "" : `, ${data.bodies[data.nearest[i][1]].name} at ${data.times_b[i].toFixed(3)} s`;

  // What is shown at this frame: the nearest pair, or the chosen one at the step where it comes closest.
  function told() {
    const pair = chosen === null ? null : data.pairs[chosen];
    if (pair === null || frame !== (pair.between ? frameOfTime(pair.time) : frameOfStep(pair.step))) return null;
    return pair;
  }

  function showFrame(i) {
    frame = Math.max(0, Math.min(n - 1, i));
    byId("scrub").value = frame;
    byId("scrub").setAttribute("aria-valuetext", `${times[frame].toFixed(3)} s, ${measured(frame)}`);
    byId("readout").textContent = "";
    const pair = told(), strong = document.createElement("strong");
    strong.textContent = pair ? `${mm(pair.clearance)} mm` : measured(frame);
    strong.style.color = colours[pair ? pair.status : data.status[frame]];
    byId("readout").append(strong, ` ${pair ? wordOf(pair.status) : word(frame)}`, document.createElement("br"),
      pair ? nameOf(pair) : between(frame), document.createElement("br"), pair && pair.between ? `${pair.time.toFixed(3)} s, ${betweenSteps(pair.step)}`
        : `${times[frame].toFixed(3)} s, ${stepText(frame)}${pair ? "" : otherTime(frame)}`);
    if (several) byId("readout").append(document.createElement("br"), ruleText(pair ? pair.rule : ruleOf(frame).name));
    for (const one of inHand(frame)) byId("readout").append(document.createElement("br"), `${one.by} holds ${one.part}`);
    for (const contact of data.contacts) if (contact.frame === frame) {
      byId("readout").append(document.createElement("br"), contact.text);
    }
    if (replay) replay.show(frame, pair);
    moveCursor();
  }

  // ---- the curve
  const toPlot = (metres) => metres * 1000;
  const curve = byId("curve");

  // One trace a status; each stretch reaches to the next step so that the curve has no gaps.
  function statusTrace(code) {
    const y = Array(n).fill(null);
    for (let i = 0; i < n; i++) if (data.status[i] === code) {
      y[i] = toPlot(clearances[i]);
      if (i + 1 < n && data.status[i + 1] < code) y[i + 1] = toPlot(clearances[i + 1]);
      if (i > 0 && data.status[i - 1] < code) y[i - 1] = toPlot(clearances[i - 1]);
    }
    return {x: Array.from(times), y, mode: "lines", line: {color: colours[code], width: 2.2}, hoverinfo: "skip", cliponaxis: false};
  }

  const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");

  function ruleHover(i) {
    if (!several) return "";
    const {name, fail, warn} = ruleOf(i);
    return `<br>${escaped(ruleText(name))}: ${limitText("fail", fail)}, ${limitText("warn", warn)}`;
  }

  function hoverTrace() {
    return {
      x: Array.from(times), y: Array.from(clearances, toPlot), mode: "lines", line: {width: 0}, opacity: 0, cliponaxis: false,
      text: Array.from(times, (t, i) =>
        `<b>${measured(i)}</b> ${word(i)}<br>${escaped(between(i))}<br>${t.toFixed(3)} s, ${stepText(i)}${escaped(otherTime(i))}${ruleHover(i)}`),
      hovertemplate: "%{text}<extra></extra>", hoverlabel: {bgcolor: css("--card"), bordercolor: css("--rule"), font: {color: css("--ink")}, align: "left"},
    };
  }

  function worstTrace() {
    const i = data.worst;
    return {
      x: [times[i]], y: [toPlot(clearances[i])], mode: "markers", hoverinfo: "skip", cliponaxis: false,
      marker: {size: 9, color: colours[data.status[i]], line: {color: css("--card"), width: 1}},
    };
  }

  // The chosen pair's own curve, where every pair was measured at every step, and its least clearance.
  function pairTraces() {
    if (chosen === null) return [];
    const pair = data.pairs[chosen], colour = css("--accent");
    const traces = [{
      x: [pair.time], y: [toPlot(pair.clearance)], mode: "markers", hoverinfo: "skip", cliponaxis: false,
      marker: {size: 9, symbol: "diamond", color: colour, line: {color: css("--card"), width: 1}},
    }];
    if (!data.curves) return traces;
    const x = decode(data.curves.times, Float64Array), y = decode(data.curves.clearances[chosen], Float32Array);
    const line = {x: Array.from(x), y: Array.from(y, toPlot), mode: "lines", line: {color: colour, width: 1.4}, hoverinfo: "skip"};
    return [line, ...traces];
  }

  function choose(place) {
    if (place === chosen) return;
    for (const cell of document.querySelectorAll("[data-pair]")) {
      cell.classList.toggle("chosen", Number(cell.dataset.pair) === place && place !== null);
    }
    chosen = place;
    byId("pair-name").textContent = place === null ? "" : nameOf(data.pairs[place]);
    byId("pair-clear").hidden = place === null;
    redraw();
  }

  function band([start, end], colour) {
    const half = n > 1 ? 0.5 * (times[n - 1] - times[0]) / (n - 1) : 0.5;
    return {type: "rect", xref: "x", yref: "paper", x0: start - half, x1: end + half, y0: 0, y1: 1, fillcolor: colour, opacity: 0.11, line: {width: 0}, layer: "below"};
  }

  // The limit that holds at each frame: one straight line, or steps where rules differ from frame to frame.
  function limitTrace([, of, colour]) {
    const level = (i) => toPlot(of(ruleOf(i))), x = [times[0]], y = [level(0)];
    for (let i = 1; i < n; i++) if (level(i) !== y[y.length - 1]) { x.push(times[i]); y.push(level(i)); }
    x.push(n > 1 ? times[n - 1] : times[0] + 1);
    y.push(y[y.length - 1]);
    return {x, y, mode: "lines", line: {color: colour, width: 1.2, dash: "4px,3px", shape: "hv"}, hoverinfo: "skip", cliponaxis: false};
  }

  // Labels stand beside their lines, at the last frame, or above and below where the lines are too near for both.
  function limitLabel([name, of, colour]) {
    const {fail, warn} = ruleOf(n - 1), metres = of(ruleOf(n - 1)), pixels = Math.max(100, curve.clientHeight - 54) / (zoomed() ? near : greatest);
    const close = fail > 0 && toPlot(warn - fail) * pixels < 14, up = name === "warn";
    const beside = {xanchor: "left", xshift: 4, yanchor: close ? (up ? "bottom" : "top") : "middle"};
    const within = {xanchor: "right", xshift: -4, yanchor: close && !up ? "top" : "bottom"};
    return {xref: "paper", x: 1, y: toPlot(metres), yshift: 0, showarrow: false, ...(isNarrow() ? within : beside),
      text: limitText(name, metres), font: {color: colour, size: 11}};
  }

  function limitText(name, metres) {
    return `${name} ${Number((metres * 1000).toPrecision(6))} mm`;
  }

  function isNarrow() { // no room for labels beside the plot
    return curve.clientWidth < 560;
  }

  function roomForLimits() { // px, right of the plot
    if (isNarrow()) return 12;
    const ruler = document.createElement("span");
    ruler.style.cssText = "position: absolute; visibility: hidden; white-space: nowrap; font-size: 11px";
    document.body.append(ruler);
    const widths = shownLimits().map(([name, of]) => {
      ruler.textContent = limitText(name, of(ruleOf(n - 1)));
      return ruler.offsetWidth;
    });
    ruler.remove();
    return 20 + Math.max(0, ...widths);
  }

  // Levels that are above 0 at some frame; warn only where it is not everywhere the same as fail.
  function shownLimits() {
    const used = [...new Set(data.rule)].map((k) => data.rules[k]);
    const levels = [["fail", (rule) => rule.fail, css("--violated")], ["warn", (rule) => rule.warn, css("--near")]];
    return levels.filter(([name, of]) => used.some((rule) => of(rule) > 0 && (name === "fail" || rule.warn > rule.fail)));
  }

  const used = [...new Set(data.rule)].map((k) => data.rules[k]);
  const lowest = Math.min(0, 1.06 * toPlot(Math.min(...finite)));
  const greatest = toPlot(Math.max(...finite, ...used.map((rule) => rule.warn))) * 1.06 || 1;
  const near = Math.min(greatest, 2.5 * toPlot(Math.max(...used.map((rule) => rule.warn), Math.min(...finite))) || greatest);

  function plotted() {
    const axis = {gridcolor: css("--grid"), zerolinecolor: css("--rule"), linecolor: css("--rule"), ticks: "outside", tickcolor: css("--rule"), fixedrange: false};
    const highest = Math.max(greatest, ...pairTraces().flatMap((trace) => trace.y.filter((y) => y === y).map((y) => 1.06 * y)));
    return {
      margin: {l: 58, r: roomForLimits(), t: 8, b: 46}, showlegend: false, hovermode: "x", hoverdistance: -1, dragmode: "zoom",
      font: {family: getComputedStyle(document.body).fontFamily, size: 12, color: css("--soft")},
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      xaxis: {...axis, title: {text: "time, s", standoff: 6}, range: [times[0], n > 1 ? times[n - 1] : times[0] + 1]},
      yaxis: {...axis, title: {text: "clearance, mm", standoff: 8}, range: [lowest, zoomed() ? near : highest]},
      shapes: [...data.intervals.below_warn.map((range) => band(range, css("--near"))),
        ...data.intervals.below_fail.map((range) => band(range, css("--violated")))],
      annotations: shownLimits().map(limitLabel),
    };
  }

  const zoomed = () => byId("zoom-limits").getAttribute("aria-pressed") === "true";
  const allTraces = () => [hoverTrace(), ...data.statuses.map((_, code) => statusTrace(code)), ...shownLimits().map(limitTrace), worstTrace(), ...pairTraces()];
  const redraw = () => Plotly.react(curve, allTraces(), plotted());

  function drawCurve() {
    const traces = allTraces(), layout = plotted();
    Plotly.newPlot(curve, traces, layout, {responsive: true, displaylogo: false, displayModeBar: false, doubleClick: "reset"});
    let wasNarrow = isNarrow();
    new ResizeObserver(() => {
      if (curve.clientHeight === 0) return; // hidden in print
      if (isNarrow() !== wasNarrow) redraw();
      wasNarrow = isNarrow();
      Plotly.Plots.resize(curve);
    }).observe(curve);
    const cursor = document.createElement("div");
    cursor.id = "cursor";
    curve.append(cursor);
    curve.on("plotly_click", (event) => { pause(); showFrame(event.points[0].pointIndex); });
    curve.on("plotly_afterplot", moveCursor);
    Plotly.toImage({data: traces, layout: onPaper(layout)}, {format: "svg", width: 860, height: 330})
      .then((image) => { byId("curve-still").src = image; });
  }

  // As it prints: dark lines on white, whatever the screen's theme.
  function onPaper(layout) {
    const axis = {gridcolor: "#eceeec", zerolinecolor: "#d9dcd8", linecolor: "#d9dcd8", tickcolor: "#d9dcd8"};
    return {...layout, paper_bgcolor: "#ffffff", font: {...layout.font, color: "#4a5664"},
      xaxis: {...layout.xaxis, ...axis}, yaxis: {...layout.yaxis, ...axis}};
  }

  function moveCursor() {
    const cursor = byId("cursor"), layout = curve._fullLayout;
    if (!cursor || !layout) return;
    const {xaxis, _size} = layout, x = xaxis.d2p(times[frame]);
    cursor.hidden = x < 0 || x > _size.w;
    cursor.style.cssText = `left:${_size.l + x}px;top:${_size.t}px;height:${_size.h}px`;
  }

  // ---- playing: frames follow the trajectory's own time
  function pause() {
    if (playing === null) return;
    cancelAnimationFrame(playing);
    playing = null;
    byId("play").textContent = "Play";
  }

  function play() {
    if (frame === n - 1) showFrame(0);
    let clock = times[frame], last = performance.now();
    const tick = (now) => {
      clock += Number(byId("speed").value) * (now - last) / 1000;
      last = now;
      let next = frame;
      while (next < n - 1 && times[next + 1] <= clock) next++;
      if (next !== frame) showFrame(next);
      if (next === n - 1) return pause();
      playing = requestAnimationFrame(tick);
    };
    byId("play").textContent = "Pause";
    playing = requestAnimationFrame(tick);
  }

  function follow(event) {
    if (event.type === "keydown" && event.key !== "Enter" && event.key !== " ") return;
    const target = event.target.closest("[data-step], [data-time]");
    if (!target) return;
    event.preventDefault();
    pause();
    const {step, time, pair} = target.dataset;
    choose(pair === undefined ? null : Number(pair));
    showFrame(time === undefined ? frameOfStep(Number(step)) : frameOfTime(Number(time)));
    byId("stage").scrollIntoView({behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth"});
  }

  function connect() {
    byId("scrub").max = n - 1;
    byId("scrub").addEventListener("input", (event) => { pause(); showFrame(Number(event.target.value)); });
    byId("play").addEventListener("click", () => (playing === null ? play() : pause()));
    byId("worst-step").addEventListener("click", () => { pause(); choose(null); showFrame(data.worst); });
    byId("camera-gap").addEventListener("click", () => replay && replay.atGap());
    byId("camera-all").addEventListener("click", () => replay && replay.overview());
    byId("zoom-limits").addEventListener("click", (event) => {
      const on = event.target.getAttribute("aria-pressed") !== "true";
      event.target.setAttribute("aria-pressed", on);
      redraw();
    });
    byId("pair-clear").addEventListener("click", () => { choose(null); showFrame(frame); });
    dark.addEventListener("change", () => { colours = palette(); redraw(); showFrame(frame); });
    document.addEventListener("click", follow);
    document.addEventListener("keydown", follow);
  }

  function startReplay() {
    try {
      replay = new Replay(byId("pane"), data, colours, dark.matches ? "dark" : "light");
    } catch (error) {
      byId("pane").textContent = "This browser cannot draw in 3-D (WebGL); every figure on this page stands without it.";
      byId("pane").classList.add("missing");
    }
  }

  startReplay();
  drawCurve();
  connect();
  showFrame(data.worst);
  if (replay) {
    replay.overview();
    requestAnimationFrame(() => { byId("replay-still").src = replay.image(); });
    window.addEventListener("beforeprint", () => { pause(); showFrame(data.worst); });
  }
  window.clearance = {showFrame, frameOfStep, pause, state: () => ({frame, step: data.steps[frame], ...(replay ? replay.state() : {})})};
})();
