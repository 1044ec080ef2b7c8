"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const root = document.documentElement;
  const byId = (id) => document.getElementById(id);
  // Okabe and Ito's palette, with the yellow and the black replaced where they would not show.
  const palettes = {
    light: {
      curves: ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#1c1f23", "#8a7a00"],
      grey: "#949aa1", ink: "#1c1f23", text: "#1c1f23", grid: "#e6e9ec", limit: "#b3261e", band: "rgba(230,159,0,0.18)",
    },
    dark: {
      curves: ["#4aa3df", "#f0803c", "#2cc79a", "#e39cc4", "#f2b134", "#a9dcf7", "#eceef0", "#f0e442"],
      grey: "#8b929a", ink: "#ffffff", text: "#e8eaed", grid: "#2c323a", limit: "#ff8a80", band: "rgba(242,177,52,0.2)",
    },
  };
  const state = { range: null, hidden: new Set(), log: false };
  const stale = new Set();
  const inView = new Set();

  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const touch = matchMedia("(pointer: coarse)");
  const palette = () => palettes[root.dataset.theme];
  const colour = (name) => (typeof name === "number" ? palette().curves[name % 8] : palette()[name]);
  const pattern = (name) => (!(name >= 4) ? "solid" : name < 8 ? "dashed" : "dotted");
  const dashes = { solid: "solid", dashed: "6px,2px", dotted: "2px,2px" };

  const panels = data.panels.map((panel, i) => ({
    ...panel,
    figure: byId(`panel-${i}`),
    plot: byId(`panel-${i}`).querySelector(".plot"),
    zoom: null, // the reader's own y range
    series: panel.series.map((s) => ({
      ...s, x: floats(s.x), y: floats(s.y), key: data.runs.length ? s.name : `${i} ${s.name}`,
    })),
  }));
  const shown = (panel) => panel.series.filter((s) => !state.hidden.has(s.key));

  /** Least and greatest value inside the time window, with the lines that the curves come near to. */
  function extent(panel) {
    const [from, to] = state.range ?? [-Infinity, Infinity];
    let low = Infinity, high = -Infinity;
    for (const s of shown(panel)) {
      s.y.forEach((y, i) => {
        const before = s.x[i + 1] < from, after = s.x[i - 1] > to; // neighbours of the window count: lines lead there
        if (Number.isFinite(y) && !before && !after) { low = Math.min(low, y); high = Math.max(high, y); }
      });
    }
    if (low > high) return [-1, 1];
    const reach = Math.max(high - low, panel.near);
    for (const value of panel.lines) {
      if (value >= high && value - high <= reach) high = value;
      if (value <= low && low - value <= reach) low = value;
    }
    const pad = Math.max(0.06 * (high - low), 1e-6);
    return [low - pad, high + pad];
  }

  function trace(panel, s) {
    const strip = panel.rows.length > 0;
    return {
      type: "scatter", mode: "lines", name: s.name, legendgroup: s.key, showlegend: false, x: s.x, y: s.y,
      line: { color: colour(s.colour), width: s.width, dash: strip ? "solid" : dashes[pattern(s.colour)], simplify: false },
      hovertemplate: strip ? `${panel.rows[s.y[0]]}<extra></extra>` : `%{y:.4g} ${panel.unit}${data.runs.length ? " at %{x}" : ""}`,
    };
  }

  function shapes(panel) {
    const across = { type: "rect", xref: "paper", x0: 0, x1: 1, yref: "y", layer: "below", line: { width: 0 } };
    const line = { color: palette().limit, width: 1.2 };
    return [
      ...panel.bands.map(([y0, y1]) => ({ ...across, y0, y1, fillcolor: palette().band })),
      ...panel.lines.map((y) => ({ ...across, type: "line", y0: y, y1: y, line })),
      ...panel.marks.map(([x]) => ({
        type: "line", x0: x, x1: x, yref: "paper", y0: 0, y1: 1, line: { color: palette().grey, width: 1.2, dash: "dot" },
      })),
    ];
  }

  function axisY(panel) {
    const base = { gridcolor: palette().grid, zerolinecolor: palette().grid, exponentformat: "power" };
    if (panel.rows.length) {
      const n = panel.rows.length;
      return {
        ...base, tickvals: panel.rows.map((_, i) => i), ticktext: panel.rows, range: [n - 0.5, -0.5],
        automargin: true, showgrid: false, zeroline: false, fixedrange: true,
      };
    }
    const axis = { ...base, title: { text: panel.unit, standoff: 4 } };
    if (panel.log && state.log) return { ...axis, type: "log", dtick: null, autorange: !panel.zoom, range: panel.zoom };
    return { ...axis, type: "linear", range: panel.zoom ?? extent(panel) };
  }

  function layout(panel) {
    return {
      margin: { l: 62, r: 26, t: 8, b: 38 },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: "system-ui, sans-serif", size: 12, color: palette().text },
      hovermode: panel.rows.length || data.runs.length ? "closest" : "x unified",
      hoverlabel: { bgcolor: getComputedStyle(root).getPropertyValue("--zone"), font: { color: palette().text } },
      dragmode: touch.matches ? false : "zoom",
      shapes: shapes(panel),
      annotations: panel.marks.map(([x, text]) => ({
        x, text, yref: "paper", y: 1, showarrow: false, xanchor: "left", yanchor: "top", font: { color: palette().text },
      })),
      xaxis: {
        gridcolor: palette().grid, zeroline: false, range: state.range ?? [0, data.end], hoverformat: ".4~f",
        ticksuffix: " s", showticksuffix: "last",
      },
      yaxis: axisY(panel),
    };
  }

  function draw(panel) {
    stale.delete(panel);
    const fresh = !panel.plot.data;
    const config = { responsive: true, displaylogo: false, displayModeBar: false, doubleClick: false, showTips: false };
    Plotly.react(panel.plot, shown(panel).map((s) => trace(panel, s)), layout(panel), config);
    if (!fresh) return;
    panel.plot.on("plotly_relayout", (change) => zoomed(panel, change));
    panel.plot.on("plotly_doubleclick", () => { panels.forEach((p) => { p.zoom = null; }); window_(null); });
  }

  /** Mark the panels as out of date; those in view are drawn at once, the others when they come into it. */
  function refresh(which = panels) {
    which.forEach((panel) => stale.add(panel));
    inView.forEach((panel) => { if (stale.has(panel)) draw(panel); });
  }

  function zoomed(panel, change) {
    if ("yaxis.range[0]" in change) panel.zoom = [change["yaxis.range[0]"], change["yaxis.range[1]"]];
    if ("xaxis.range[0]" in change) window_([change["xaxis.range[0]"], change["xaxis.range[1]"]]);
  }

  /** Show this time window [s] in every plot; null is the whole run. */
  function window_(range) {
    state.range = range;
    const [from, to] = range ?? [0, data.end];
    byId("from").value = +from.toFixed(4);
    byId("to").value = +to.toFixed(4);
    refresh();
  }

  /** A legend entry that hides and shows the curves with its key. */
  function keyButton(name, key, colourName, which) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "key";
    button.setAttribute("aria-pressed", "true");
    const swatch = document.createElement("i");
    swatch.dataset.colour = JSON.stringify(colourName);
    swatch.className = pattern(colourName);
    button.append(swatch, name);
    button.addEventListener("click", () => {
      const hide = !state.hidden.has(key);
      if (hide) state.hidden.add(key); else state.hidden.delete(key);
      button.setAttribute("aria-pressed", String(!hide));
      refresh(which);
    });
    return button;
  }

  function addKeys() {
    data.runs.forEach((name, i) => byId("runs").append(keyButton(name, name, i, panels)));
    if (data.runs.length) return;
    for (const panel of panels) {
      if (panel.series.length < 2 || panel.rows.length) continue;
      const keys = document.createElement("div");
      keys.className = "keys";
      keys.append(...panel.series.map((s) => keyButton(s.name, s.key, s.colour, [panel])));
      panel.figure.querySelector("figcaption").append(keys);
    }
  }

  function useTheme(theme) {
    root.dataset.theme = theme;
    byId("theme").textContent = theme === "dark" ? "Light" : "Dark";
    document.querySelectorAll(".key i").forEach((i) => { i.style.borderColor = colour(JSON.parse(i.dataset.colour)); });
    refresh();
  }

  addKeys();
  useTheme(root.dataset.theme);
  window_(null);
  byId("log").hidden = !panels.some((panel) => panel.log);
  dark.addEventListener("change", () => useTheme(dark.matches ? "dark" : "light"));
  byId("theme").addEventListener("click", () => useTheme(root.dataset.theme === "dark" ? "light" : "dark"));
  byId("whole").addEventListener("click", () => { panels.forEach((p) => { p.zoom = null; }); window_(null); });
  byId("log").addEventListener("click", () => {
    state.log = !state.log;
    byId("log").setAttribute("aria-pressed", String(state.log));
    panels.forEach((p) => { if (p.log) p.zoom = null; });
    refresh(panels.filter((panel) => panel.log));
  });
  byId("controls").addEventListener("submit", (event) => event.preventDefault());
  byId("controls").addEventListener("change", () => {
    const [from, to] = [byId("from").valueAsNumber, byId("to").valueAsNumber];
    if (from < to) window_([from, to]);
  });
  addEventListener("beforeprint", () => panels.forEach((panel) => draw(panel)));

  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const panel = panels.find((p) => p.plot === entry.target);
      if (!entry.isIntersecting) { inView.delete(panel); continue; }
      inView.add(panel);
      if (stale.has(panel)) draw(panel);
    }
  }, { rootMargin: "300px" });
  panels.forEach((panel) => watcher.observe(panel.plot));
})();
