// A chart of clearance over time as SVG: curves, limit lines, bands, marks; values under the pointer, zoom by dragging,
// a click that picks a moment. Colours are classes of the page's style: dark, light and print need no other drawing.
"use strict";

const SVG = "http://www.w3.org/2000/svg";

function drawn(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// Round numbers in a range, at most so many.
function ticks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((one) => one >= raw * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({length: Math.max(0, last - first + 1)}, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

// The place in increasing numbers that is nearest to one.
function nearest(numbers, wanted) {
  let low = 0, high = numbers.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] < wanted) low = middle + 1; else high = middle;
  }
  return low > 0 && wanted - numbers[low - 1] < numbers[low] - wanted ? low - 1 : low;
}

// Millimetres rounded down: what is shown is never more than what was measured.
function down(value) {
  const scaled = Math.floor(Number((value * 1000).toPrecision(15)));
  return ((scaled / 1000 > value ? scaled - 1 : scaled) / 1000).toFixed(3);
}

class Chart {
  // content(): what is drawn, in s and mm: span, range, main {x, y}, tip(i) lines; curves {name, x, y, kind, filled},
  // limits {x, y, text, kind}, bands {start, end, kind}, marks {x, y, kind}. picked(i): a moment of main is clicked.
  constructor(place, content, picked = null) {
    this.place = place;
    this.content = content;
    this.picked = picked;
    this.zoom = null;
    this.svg = drawn("svg", {class: "chart", role: "img", "aria-label": "Clearance over time"});
    this.tip = document.createElement("output");
    this.tip.className = "tip";
    this.tip.hidden = true;
    this.cursor = drawn("line", {class: "cursor"});
    this.pointer = drawn("line", {class: "pointer"});
    this.dragged = drawn("rect", {class: "dragged"});
    place.append(this.svg, this.tip);
    this.listen();
    new ResizeObserver(() => { if (place.clientHeight) this.draw(); }).observe(place);
    this.draw();
  }

  x(time) {
    return this.room.left + (time - this.span[0]) / (this.span[1] - this.span[0]) * this.room.width;
  }

  y(value) {
    return this.room.top + (this.range[1] - value) / (this.range[1] - this.range[0]) * this.room.height;
  }

  draw() {
    const width = this.place.clientWidth || 860, height = this.place.clientHeight || 330;
    const told = this.told = this.content(), narrow = width < 560;
    const widest = Math.max(0, ...told.limits.map((one) => one.text.length));
    const keys = this.keys(told.curves, width), below = 18 * (keys.length ? 1 + keys.at(-1).row : 0);
    this.room = {left: 58, top: 8, width: width - 58 - (narrow || !widest ? 14 : 16 + 6.7 * widest), height: height - 54 - below};
    this.span = this.zoom ? this.zoom.span : told.span;
    this.range = this.zoom ? this.zoom.range : told.range;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const {left, top, width: wide, height: high} = this.room;
    const clip = drawn("clipPath", {id: "plot"}, drawn("rect", {x: left - 1, y: top - 5, width: wide + 2, height: high + 10}));
    const inside = drawn("g", {"clip-path": "url(#plot)"}, ...told.bands.map((one) => this.band(one)), ...told.curves.flatMap((one, i) => this.fill(one, i)),
      ...told.curves.map((one) => this.curve(one)), ...told.limits.map((one) => this.limit(one)), ...told.marks.map((one) => this.mark(one)), this.pointer, this.cursor);
    this.svg.replaceChildren(clip, ...this.grid(), inside, ...this.labels(narrow), ...this.legend(keys), this.dragged);
    this.at(this.time);
  }

  // The cursor stands at a time.
  at(time) {
    this.time = time;
    this.upright(this.cursor, time);
  }

  upright(line, time) {
    const seen = time !== undefined && time >= this.span[0] && time <= this.span[1];
    line.style.display = seen ? "" : "none";
    if (seen) for (const [name, value] of [["x1", this.x(time)], ["x2", this.x(time)], ["y1", this.room.top], ["y2", this.room.top + this.room.height]]) line.setAttribute(name, value);
  }

  grid() {
    const {left, top, width, height} = this.room, low = top + height, found = [];
    const text = (x, y, told, anchor, more = {}) => drawn("text", {x, y, "text-anchor": anchor, ...more}, told);
    for (const time of ticks(...this.span, Math.max(2, width / 80))) {
      found.push(drawn("line", {class: "grid", x1: this.x(time), x2: this.x(time), y1: top, y2: low + 4}), text(this.x(time), low + 18, `${time}`, "middle"));
    }
    for (const value of ticks(...this.range, Math.max(2, height / 45))) {
      found.push(drawn("line", {class: value === 0 ? "zero" : "grid", x1: left - 4, x2: left + width, y1: this.y(value), y2: this.y(value)}), text(left - 8, this.y(value) + 4, `${value}`, "end"));
    }
    found.push(text(left + width / 2, low + 38, "time, s", "middle"));
    found.push(text(14, top + height / 2, "clearance, mm", "middle", {transform: `rotate(-90 14 ${top + height / 2})`}));
    return found;
  }

  // A line through points, with gaps where there is no value; `steps`: level up to the next point.
  path(x, y, steps = false) {
    let told = "", open = false;
    for (let i = 0; i < x.length; i++) {
      if (!Number.isFinite(y[i])) { open = false; continue; }
      const at = [this.x(x[i]).toFixed(1), this.y(y[i]).toFixed(1)];
      told += !open ? `M${at}` : steps ? `H${at[0]}V${at[1]}` : `L${at}`;
      open = true;
    }
    return told;
  }

  curve({x, y, kind}) {
    return drawn("path", {class: `curve ${kind}`, d: this.path(x, y)});
  }

  // The space to the curve before, in one piece for each stretch in which both have values.
  fill({x, y, filled}, i) {
    if (!filled) return [];
    const before = this.told.curves[i - 1], stretches = [[]];
    for (const k of x.keys()) Number.isFinite(y[k]) && Number.isFinite(before.y[k]) ? stretches.at(-1).push(k) : stretches.push([]);
    const piece = (known) => {
      const corners = [...known.map((k) => [x[k], y[k]]), ...known.reverse().map((k) => [before.x[k], before.y[k]])];
      return this.path(corners.map(([time]) => time), corners.map(([, value]) => value)) + "Z";
    };
    return [drawn("path", {class: "filled", d: stretches.filter((known) => known.length).map(piece).join("")})];
  }

  band({start, end, kind}) {
    return drawn("rect", {class: `band ${kind}`, x: this.x(start), width: Math.max(0, this.x(end) - this.x(start)), y: this.room.top, height: this.room.height});
  }

  limit({x, y, kind}) {
    return drawn("path", {class: `limit ${kind}`, d: this.path(x, y, true)});
  }

  mark({x, y, kind}) {
    if (!Number.isFinite(y)) return "";
    const place = {class: `mark ${kind}`, transform: `translate(${this.x(x)} ${this.y(y)})`};
    return kind === "pair" ? drawn("path", {...place, d: "M0-6L6 0L0 6L-6 0Z"}) : drawn("circle", {...place, r: 5});
  }

  // Beside the lines, where they end; within the plot where it is narrow; apart where two are too near for both.
  labels(narrow) {
    const {left, top, width, height} = this.room, levels = this.told.limits.map((one) => this.y(one.y.at(-1)));
    return this.told.limits.flatMap(({text, kind}, i) => {
      const y = levels[i], close = levels.some((other, k) => k !== i && Math.abs(other - y) < 14);
      if (y < top - 1 || y > top + height + 1) return [];
      const lift = narrow ? (close && y === Math.max(...levels) ? 13 : -4) : close ? (y === Math.max(...levels) ? 12 : -4) : 4;
      const at = narrow ? {x: left + width - 4, "text-anchor": "end"} : {x: left + width + 6, "text-anchor": "start"};
      return [drawn("text", {...at, y: y + lift, class: `label ${kind}`}, text)];
    });
  }

  // The place of each name below the chart, side by side in as few rows as the width takes.
  keys(curves, width) {
    let left = 58, row = 0;
    return curves.filter((one) => one.name).map(({name, kind}) => {
      const wide = 48 + 6.7 * name.length;
      if (left > 58 && left + wide > width) { left = 58; row += 1; }
      left += wide;
      return {name, kind, row, left: left - wide};
    });
  }

  legend(keys) {
    const top = this.room.top + this.room.height + 54;
    return keys.flatMap(({name, kind, row, left}) => [drawn("path", {class: `curve ${kind}`, d: `M${left} ${top + 18 * row - 4}h26`}),
      drawn("text", {class: "key", x: left + 32, y: top + 18 * row}, name)]);
  }

  listen() {
    const at = (event) => {
      const box = this.svg.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    let from = null;
    this.svg.addEventListener("pointerdown", (event) => { if (event.button === 0) from = at(event); });
    this.svg.addEventListener("pointermove", (event) => {
      const to = at(event);
      if (from && this.isDrag(from, to)) this.drag(from, to); else this.hover(to);
    });
    this.svg.addEventListener("pointerup", (event) => {
      const to = at(event), begun = from;
      from = null;
      this.dragged.setAttribute("width", 0);
      if (begun && this.isDrag(begun, to)) this.zoomTo(begun, to);
      else if (begun && this.picked) this.picked(nearest(this.told.main.x, this.timeAt(to[0])));
    });
    this.svg.addEventListener("pointerleave", () => { from = null; this.dragged.setAttribute("width", 0); this.hover(null); });
    this.svg.addEventListener("dblclick", () => { this.zoom = null; this.draw(); });
  }

  isDrag([x0, y0], [x1, y1]) {
    return Math.max(Math.abs(x1 - x0), Math.abs(y1 - y0)) > 8;
  }

  timeAt(x) {
    return this.span[0] + (x - this.room.left) / this.room.width * (this.span[1] - this.span[0]);
  }

  valueAt(y) {
    return this.range[1] - (y - this.room.top) / this.room.height * (this.range[1] - this.range[0]);
  }

  // Left, top, right and bottom of what is dragged, in the plot; all of it in a direction in which it is thin.
  between([x0, y0], [x1, y1]) {
    const {left, top, width, height} = this.room, within = (value, low, size) => Math.min(Math.max(value, low), low + size);
    const across = Math.abs(x1 - x0) > 8 ? [within(Math.min(x0, x1), left, width), within(Math.max(x0, x1), left, width)] : [left, left + width];
    const along = Math.abs(y1 - y0) > 12 ? [within(Math.min(y0, y1), top, height), within(Math.max(y0, y1), top, height)] : [top, top + height];
    return [across[0], along[0], across[1], along[1]];
  }

  drag(from, to) {
    const [left, top, right, low] = this.between(from, to);
    this.hover(null);
    for (const [name, value] of Object.entries({x: left, y: top, width: right - left, height: low - top})) this.dragged.setAttribute(name, value);
  }

  zoomTo(from, to) {
    const [left, top, right, low] = this.between(from, to);
    if (right - left < 1 || low - top < 1) return;
    this.zoom = {span: [this.timeAt(left), this.timeAt(right)], range: [this.valueAt(low), this.valueAt(top)]};
    this.draw();
  }

  // Values at the moment that is nearest to the pointer.
  hover(place) {
    const {x: times, y: values} = this.told.main;
    this.tip.hidden = !place || !times.length;
    this.upright(this.pointer, this.tip.hidden ? undefined : times[nearest(times, this.timeAt(place[0]))]);
    if (this.tip.hidden) return;
    const i = nearest(times, this.timeAt(place[0])), lines = [...this.told.tip(i), ...this.others(times[i])];
    this.tip.replaceChildren(...lines.map((line, k) => {
      const made = document.createElement(k ? "div" : "strong");
      made.textContent = line;
      return made;
    }));
    const x = this.x(times[i]), right = x > this.room.left + this.room.width / 2;
    const height = this.tip.offsetHeight, y = Number.isFinite(values[i]) ? this.y(values[i]) : this.room.top;
    this.tip.style.left = `${right ? Math.max(0, x - 12 - this.tip.offsetWidth) : x + 12}px`;
    this.tip.style.top = `${Math.min(Math.max(0, y - height / 2), Math.max(0, this.room.top + this.room.height - height))}px`;
  }

  others(time) {
    return this.told.curves.filter((one) => one.name).flatMap(({name, x, y}) => {
      const value = y[nearest(x, time)];
      return Number.isFinite(value) ? [`${name} ${down(value)} mm`] : [];
    });
  }

  // Curves side by side with one limit, as a page without a replay has them.
  static ofCurves(place, {curves, limit, called}) {
    const told = curves.map(({name, times, clearances}, i) => ({name, x: times, y: clearances, kind: `c${i}`}));
    const times = [...new Set(told.flatMap(({x}) => x))].sort((a, b) => a - b), every = told.flatMap(({y}) => y.filter(Number.isFinite));
    const span = [times[0], times.at(-1) > times[0] ? times.at(-1) : times[0] + 1];
    const content = () => ({
      span, range: [Math.min(0, ...every.map((value) => 1.06 * value)), 1.06 * Math.max(limit, ...every, 1e-3)], main: {x: times, y: []},
      tip: (i) => [`${times[i].toFixed(3)} s`], curves: told, bands: [], marks: [],
      limits: limit > 0 ? [{x: span, y: [limit, limit], text: `${called} ${Number(limit.toPrecision(6))} mm`, kind: "violated"}] : [],
    });
    return new Chart(place, content);
  }
}
