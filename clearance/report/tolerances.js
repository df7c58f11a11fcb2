// What tolerances leave, below the margin curve. It takes part in every drawing of the curve, and only pages of cases
// with tolerances hold it.
"use strict";

(() => {
  const {budget} = JSON.parse(document.getElementById("data").textContent);
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const x = Array.from(decode(budget.times, Float64Array));
  const toPlot = (metres) => (Number.isFinite(metres) ? metres * 1000 : null);
  const down = (value) => (Math.floor(Number((value * 1000).toPrecision(15))) / 1000).toFixed(3);
  const least = (values) => values.reduce((low, y) => (y === null || y >= low ? low : y), 0);
  const [proven, expected] = [budget.proven, budget.expected].map((part) => Array.from(decode(part, Float64Array), toPlot));

  function traces() {
    const line = (y, name, dash, more) => ({
      x, y, mode: "lines", line: {color: css("--accent"), width: 1.3, dash}, cliponaxis: false,
      text: y.map((value) => (value === null ? "" : `${name} ${down(value)} mm`)), hovertemplate: "%{text}<extra></extra>",
      hoverlabel: {bgcolor: css("--card"), bordercolor: css("--rule"), font: {color: css("--ink")}}, ...more,
    });
    return [line(proven, "proven with tolerances", "solid", {}),
      line(expected, "expected, an estimate", "dot", {fill: "tonexty", fillcolor: css("--accent") + "26"})];
  }

  const lowest = 1.06 * Math.min(least(proven), least(expected));
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
