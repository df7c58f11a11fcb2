"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const height = 32, beyond = 8, n = data.names.length;
  const bytes = Uint8Array.from(atob(data.curves), (letter) => letter.charCodeAt(0));
  const text = (table, i) => (i < 0 ? "" : table[i]);
  const columns = {
    name: data.names,
    status: data.status,
    clearance: data.clearance,
    bound: data.bound,
    time: data.time,
    a: data.a.map((i) => text(data.bodies, i)),
    b: data.b.map((i) => text(data.bodies, i)),
    rule: data.rule.map((i) => text(data.rules, i)),
  };
  let order = [], sortedBy = "status", descending = true, chosen = -1;

  const fill = (select, values) => {
    for (const value of values) select.append(new Option(value, value));
  };
  fill(byId("by-status"), data.statuses.filter((_, i) => data.status.includes(i)));
  fill(byId("by-rule"), [...data.rules].sort());
  fill(byId("by-body"), [...data.bodies].sort());

  function isShown(i) {
    const [find, status, rule, body] = ["find", "by-status", "by-rule", "by-body"].map((id) => byId(id).value);
    return (
      (!find || data.names[i].toLowerCase().includes(find.toLowerCase())) &&
      (!status || data.statuses[data.status[i]] === status) &&
      (!rule || columns.rule[i] === rule) &&
      (!body || columns.a[i] === body || columns.b[i] === body)
    );
  }

  function compare(i, j) {
    const one = columns[sortedBy][i], other = columns[sortedBy][j];
    if (one === other) return sortedBy === "status" ? leastFirst(i, j) : i - j;
    if (one === null) return 1;
    if (other === null) return -1;
    return (one < other ? -1 : 1) * (descending ? -1 : 1);
  }

  function leastFirst(i, j) {
    const one = data.clearance[i], other = data.clearance[j];
    return one === null || other === null ? i - j : one - other || i - j;
  }

  function arrange() {
    order = [];
    for (let i = 0; i < n; i++) if (isShown(i)) order.push(i);
    order.sort(compare);
    byId("space").style.height = `${order.length * height}px`;
    byId("shown").textContent = `${order.length.toLocaleString("en")} of ${n.toLocaleString("en")} cases`;
    draw();
  }

  function cell(content, name) {
    const made = document.createElement("span");
    made.textContent = content;
    made.title = content;
    made.setAttribute("role", "cell");
    if (name) made.className = name;
    return made;
  }

  const shown = (number, digits) => (number === null ? "" : number.toFixed(digits));

  // The clearance; of a contact how deep it is at most, if that is known.
  function least(i) {
    const least = data.clearance[i], touches = data.touches[i];
    return least < 0 ? `${(-least).toFixed(3)} deep` : touches ? "contact" : shown(least, 3);
  }

  function curve(i) {
    const canvas = document.createElement("canvas"), scale = window.devicePixelRatio || 1;
    canvas.width = 260 * scale;
    canvas.height = 26 * scale;
    const own = bytes.subarray(i * data.n_curve, (i + 1) * data.n_curve);
    if (own.length === 0 || own[0] === 0) return canvas;
    const pen = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    pen.scale(scale, scale);
    const y = (share) => 25 - 24 * share;
    ["--violated", "--near"].forEach((name, k) => {
      pen.strokeStyle = style.getPropertyValue(name);
      pen.globalAlpha = 0.45;
      pen.beginPath();
      pen.moveTo(0, y(data.levels[i][k]));
      pen.lineTo(260, y(data.levels[i][k]));
      pen.stroke();
    });
    pen.globalAlpha = 1;
    pen.strokeStyle = style.getPropertyValue("--ink");
    pen.beginPath();
    own.forEach((byte, k) => pen.lineTo((k / (data.n_curve - 1)) * 260, y((byte - 1) / 254)));
    pen.stroke();
    return canvas;
  }

  function row(i) {
    const made = document.createElement("div");
    made.className = "row";
    made.setAttribute("role", "row");
    made.setAttribute("aria-selected", String(i === chosen));
    made.dataset.case = data.names[i];
    const tag = cell("");
    const badge = document.createElement("b");
    badge.className = `tag ${data.shade[i]}`;
    badge.textContent = badge.title = text(data.headlines, data.headline[i]);
    tag.append(badge);
    made.append(
      cell(data.names[i]), tag, cell(least(i), "number"), cell(shown(data.bound[i], 3), "number"),
      cell(shown(data.time[i], 3), "number"), cell(columns.a[i]), cell(columns.b[i]), cell(columns.rule[i]), curve(i),
    );
    made.addEventListener("click", () => choose(i));
    return made;
  }

  function draw() {
    const view = byId("view"), first = Math.max(0, Math.floor(view.scrollTop / height) - beyond);
    const last = Math.min(order.length, Math.ceil((view.scrollTop + view.clientHeight) / height) + beyond);
    byId("rows").style.top = `${first * height}px`;
    byId("rows").replaceChildren(...order.slice(first, last).map(row));
  }

  function quoted(argument) {
    return /^[\w./-]+$/.test(argument) ? argument : `'${argument.replaceAll("'", "'\\''")}'`;
  }

  function choose(i) {
    chosen = i;
    byId("chosen").hidden = false;
    byId("chosen-name").textContent = data.names[i];
    const lines = [...new Set([text(data.headlines, data.headline[i]), ...data.reasons[i], ...data.notes[i]])];
    byId("chosen-reasons").replaceChildren(
      ...lines.map((line) => {
        const made = document.createElement("li");
        made.textContent = line;
        return made;
      }),
    );
    byId("chosen-command").textContent = `clearance view ${quoted(data.store)} ${quoted(data.names[i])}`;
    const link = byId("chosen-page");
    const page = data.pages[i] || "";
    link.hidden = !page;
    link.href = page ? `${page}/report.html` : "";
    draw();
  }

  for (const head of document.querySelectorAll("#head [data-key]")) {
    head.addEventListener("click", () => {
      descending = sortedBy === head.dataset.key && !descending;
      sortedBy = head.dataset.key;
      for (const other of document.querySelectorAll("#head [aria-sort]")) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", descending ? "descending" : "ascending");
      arrange();
    });
  }
  byId("filters").addEventListener("input", arrange);
  byId("filters").addEventListener("submit", (event) => event.preventDefault());
  byId("view").addEventListener("scroll", draw);
  window.addEventListener("resize", draw);
  byId("copy").addEventListener("click", () => navigator.clipboard?.writeText(byId("chosen-command").textContent));
  arrange();
})();
