// Curves beside the margin curve: what tolerances leave, what was asked of a recorded run. They take part in every
// drawing of it, and only pages that have some hold this.
"use strict";

(() => {
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const toPlot = (metres) => (Number.isFinite(metres) ? metres * 1000 : null);
  const down = (value) => (Math.floor(Number((value * 1000).toPrecision(15))) / 1000).toFixed(3);
  const curves = JSON.parse(document.getElementById("data").textContent).more.map((one) => ({
    ...one, x: Array.from(decode(one.times, Float64Array)), y: Array.from(decode(one.values, Float64Array), toPlot),
  }));

  const trace = ({name, x, y, dash, filled}) => ({
    x, y, mode: "lines", line: {color: css("--accent"), width: 1.3, dash}, cliponaxis: false,
    text: y.map((value) => (value === null ? "" : `${name} ${down(value)} mm`)), hovertemplate: "%{text}<extra></extra>",
    hoverlabel: {bgcolor: css("--card"), bordercolor: css("--rule"), font: {color: css("--ink")}},
    ...(filled ? {fill: "tonexty", fillcolor: css("--accent") + "26"} : {}),
  });
  const traces = () => curves.map(trace);

  const every = curves.flatMap(({y}) => y.filter((value) => value !== null));
  const lowest = 1.06 * every.reduce((low, value) => Math.min(low, value), 0);
  const lower = (layout) => {
    const [low, high] = layout.yaxis.range;
    return {...layout, yaxis: {...layout.yaxis, range: [Math.min(low, lowest), high]}};
  };
  for (const name of ["newPlot", "react"]) {
    const draw = Plotly[name];
    Plotly[name] = (place, drawn, layout, ...others) => draw(place, [...drawn, ...traces()], lower(layout), ...others);
  }
  const toImage = Plotly.toImage;
  Plotly.toImage = (figure, ...others) =>
    toImage({...figure, data: [...figure.data, ...traces()], layout: lower(figure.layout)}, ...others);
})();
