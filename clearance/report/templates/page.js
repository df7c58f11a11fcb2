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
    const places = 10 ** decimals, scaled = Math.floor(Number((value * places).toPrecision(15)));
    return ((scaled / (places * 1000) > metres ? scaled - 1 : scaled) / places).toFixed(decimals);
  }

  // Where no pair is left to measure, no bound holds: it is infinite.
  const finite = clearances.filter(Number.isFinite);
  const measured = (i) => !Number.isFinite(clearances[i]) ? "nothing measured" : `${data.known[i] ? "" : "at least "}${mm(clearances[i])} mm`;
  const between = (i) => !Number.isFinite(clearances[i]) ? "no pair is left" : !data.known[i] ? "not measured further" : data.nearest[i].map((k) => (k < 0 ? "–" : data.bodies[k].name)).join(" – ");
  const wordOf = (code) => ({clear: "clear", near: "near miss", violated: "violated", contact: "contact"})[data.statuses[code]];
  // Where a bound is all that is known and lies below a limit, or nothing is measured, there is no status.
  const unknown = (i) => !Number.isFinite(clearances[i]) || (!data.known[i] && data.status[i] === 0 && (clearances[i] < ruleOf(i).warn || clearances[i] <= 0));
  const word = (i) => unknown(i) ? "status unknown" : wordOf(data.status[i]);
  const colourOf = (i) => unknown(i) ? css("--faint") : colours[data.status[i]];
  const nameOf = (pair) => pair.bodies.map((k) => data.bodies[k].name).join(" – ");

  const frameOfStep = (step) => nearest(data.steps, step);
  const frameOfTime = (time) => nearest(times, time);
  const frameOfPair = (pair) => pair.between ? frameOfTime(pair.time) : frameOfStep(pair.step);

  const shown = (k) => k.toLocaleString("en");
  const betweenSteps = (step) => `between the steps ${shown(step)} and ${shown(step + 1)}`;
  const seconds = (time, i) => `${time.toFixed(3)} s${data.move[i] < 0 ? "" : ` in ${data.moves[data.move[i]]}`}`;
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
    return pair === null || frame !== frameOfPair(pair) ? null : pair;
  }

  // The most critical moment; that of a pair of its own where a waived pair hides it on the curve.
  function showWorst() {
    const place = data.worst_pair ?? null;
    choose(place);
    showFrame(place === null ? data.worst : frameOfPair(data.pairs[place]));
  }

  function showFrame(i) {
    frame = Math.max(0, Math.min(n - 1, i));
    byId("scrub").value = frame;
    byId("readout").textContent = "";
    const pair = told(), strong = document.createElement("strong");
    strong.textContent = pair ? `${mm(pair.clearance)} mm` : measured(frame);
    byId("scrub").setAttribute("aria-valuetext", `${seconds(pair ? pair.time : times[frame], frame)}, ${strong.textContent}`);
    strong.style.color = pair ? colours[pair.status] : colourOf(frame);
    byId("readout").append(strong, ` ${pair ? wordOf(pair.status) : word(frame)}`, document.createElement("br"),
      pair ? nameOf(pair) : between(frame), document.createElement("br"), pair && pair.between ? `${seconds(pair.time, frame)}, ${betweenSteps(pair.step)}`
        : `${seconds(times[frame], frame)}, ${stepText(frame)}${pair ? "" : otherTime(frame)}`);
    if (several) byId("readout").append(document.createElement("br"), ruleText(pair ? pair.rule : ruleOf(frame).name));
    for (const one of inHand(frame)) byId("readout").append(document.createElement("br"), `${one.by} holds ${one.part}`);
    for (const contact of data.contacts) if (contact.frame === frame) {
      byId("readout").append(document.createElement("br"), contact.text);
    }
    if (replay) replay.show(frame, pair);
    chart.at(times[frame]);
  }

  // ---- the curve
  const toPlot = (metres) => metres * 1000;
  const clearancesShown = Array.from(clearances, toPlot), timesShown = Array.from(times);

  // A curve has a gap where nothing is measured from one of its points to the next.
  function broken(x, y) {
    const made = {x: [], y: []}, put = (time, value) => { made.x.push(time); made.y.push(value); };
    x.forEach((time, i) => {
      if (i > 0 && data.unmeasured.some(([start, end]) => x[i - 1] < end && start < time)) put((x[i - 1] + time) / 2, null);
      put(time, y[i]);
    });
    return made;
  }

  // One curve a status; each stretch reaches to the next step so that the curve has no other gaps. Dashed where nothing
  // is known between the samples. The curve of code -1 is of bounds whose status is unknown.
  const codes = Array.from(data.status, (code, i) => unknown(i) ? -1 : code);
  function statusCurve(code) {
    const y = Array(n).fill(null);
    for (let i = 0; i < n; i++) if (codes[i] === code) {
      y[i] = clearancesShown[i];
      if (i + 1 < n && codes[i + 1] < code) y[i + 1] = clearancesShown[i + 1];
      if (i > 0 && codes[i - 1] < code) y[i - 1] = clearancesShown[i - 1];
    }
    return {...broken(timesShown, y), kind: code < 0 ? "status unknown dash" : `status ${data.statuses[code]}${data.sampled ? " dash" : ""}`};
  }

  const statusCurves = [-1, ...data.statuses.keys()].map(statusCurve);

  // Beside the curve: what errors leave of it, what was asked of a recorded run.
  const moreCurves = (data.more || []).map(({name, times: x, values, kind, filled}) => (
    {name, x: Array.from(decode(x, Float64Array)), y: Array.from(decode(values, Float64Array), toPlot), kind: `more ${kind}`, filled}));

  // The chosen pair's own curve, where every pair was measured at every step.
  function pairCurves() {
    if (chosen === null || !data.curves) return [];
    const x = decode(data.curves.times, Float64Array), y = decode(data.curves.clearances[chosen], Float32Array);
    return [{name: nameOf(data.pairs[chosen]), ...broken(Array.from(x), Array.from(y, toPlot)), kind: "pair"}];
  }

  function marks() {
    const i = data.worst, found = [{x: times[i], y: clearancesShown[i], kind: data.statuses[data.status[i]]}];
    if (chosen === null) return found;
    return [...found, {x: data.pairs[chosen].time, y: toPlot(data.pairs[chosen].clearance), kind: "pair"}];
  }

  function tip(i) {
    const {name, fail, warn} = ruleOf(i), rule = several ? [`${ruleText(name)}: ${limitText("fail", fail)}, ${limitText("warn", warn)}`] : [];
    return [`${measured(i)} ${word(i)}`, between(i), `${seconds(times[i], i)}, ${stepText(i)}${otherTime(i)}`, ...rule];
  }

  function choose(place) {
    if (place === chosen) return;
    for (const cell of document.querySelectorAll("[data-pair]")) {
      cell.classList.toggle("chosen", Number(cell.dataset.pair) === place && place !== null);
    }
    chosen = place;
    byId("pair-name").textContent = place === null ? "" : nameOf(data.pairs[place]);
    byId("pair-clear").hidden = place === null;
    chart.draw();
  }

  // The limit that holds at each frame: one straight line, or steps where rules differ from frame to frame.
  function limitLine([name, of, kind]) {
    const level = (i) => toPlot(of(ruleOf(i))), x = [times[0]], y = [level(0)];
    for (let i = 1; i < n; i++) if (level(i) !== y[y.length - 1]) { x.push(times[i]); y.push(level(i)); }
    x.push(n > 1 ? times[n - 1] : times[0] + 1);
    y.push(y[y.length - 1]);
    return {x, y, kind, text: limitText(name, of(ruleOf(n - 1)))};
  }

  function limitText(name, metres) {
    return `${name} ${Number((metres * 1000).toPrecision(6))} mm`;
  }

  // Levels that are above 0 at some frame; warn only where it is not everywhere the same as fail.
  const used = [...new Set(data.rule)].map((k) => data.rules[k]);
  const limits = [["fail", (rule) => rule.fail, "violated"], ["warn", (rule) => rule.warn, "near"]]
    .filter(([name, of]) => used.some((rule) => of(rule) > 0 && (name === "fail" || rule.warn > rule.fail))).map(limitLine);

  const half = n > 1 ? 0.5 * (times[n - 1] - times[0]) / (n - 1) : 0.5;
  const bands = [["below_warn", "near"], ["below_fail", "violated"]].flatMap(([level, kind]) =>
    data.intervals[level].map(([start, end]) => ({start: start - half, end: end + half, kind})))
    .concat(data.unmeasured.map(([start, end]) => ({start, end, kind: "unmeasured"})));

  const extreme = (curves, of) => curves.reduce((found, {y}) => y.reduce((best, value) => (Number.isFinite(value) ? of(best, value) : best), found), 0);
  const lowest = 1.06 * Math.min(0, toPlot(Math.min(...finite)), extreme(moreCurves, Math.min));
  const greatest = toPlot(Math.max(...finite, ...used.map((rule) => rule.warn))) * 1.06 || 1;
  const near = Math.min(greatest, 2.5 * toPlot(Math.max(...used.map((rule) => rule.warn), Math.min(...finite))) || greatest);
  const zoomed = () => byId("zoom-limits").getAttribute("aria-pressed") === "true";

  const chart = new Chart(byId("curve"), () => ({
    span: [times[0], n > 1 ? times[n - 1] : times[0] + 1],
    range: [lowest, zoomed() ? near : Math.max(greatest, 1.06 * extreme(pairCurves(), Math.max))],
    main: {x: timesShown, y: clearancesShown}, tip, bands, limits, marks: marks(),
    curves: [...statusCurves, ...moreCurves, ...pairCurves()],
  }), (i) => { pause(); showFrame(i); });

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
    byId("worst-step").addEventListener("click", () => { pause(); showWorst(); });
    byId("camera-gap").addEventListener("click", () => replay && replay.atGap());
    byId("camera-all").addEventListener("click", () => replay && replay.overview());
    byId("zoom-limits").addEventListener("click", (event) => {
      const on = event.target.getAttribute("aria-pressed") !== "true";
      event.target.setAttribute("aria-pressed", on);
      chart.zoom = null;
      chart.draw();
    });
    byId("earlier-motion").hidden = !(replay && data.earlier);
    byId("earlier-motion").addEventListener("click", (event) => {
      replay.showsEarlier = !replay.showsEarlier;
      event.target.setAttribute("aria-pressed", replay.showsEarlier);
      showFrame(frame);
    });
    byId("pair-clear").addEventListener("click", () => { choose(null); showFrame(frame); });
    dark.addEventListener("change", () => {
      colours = palette();
      if (replay) replay.colours = colours;
      showFrame(frame);
    });
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
  connect();
  showWorst();
  if (replay) {
    replay.overview();
    requestAnimationFrame(() => { byId("replay-still").src = replay.image(); });
    window.addEventListener("beforeprint", () => { pause(); showWorst(); });
  }
  window.clearance = {chart, showFrame, frameOfStep, pause, state: () => ({frame, step: data.steps[frame], ...(replay ? replay.state() : {})})};
})();
