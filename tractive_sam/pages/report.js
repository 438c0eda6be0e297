"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const BLUE = "#0072B2", VERMILLION = "#D55E00", GREEN = "#009E73", GREY = "#6E6E6E",
  COLOURS = [BLUE, VERMILLION, GREEN, "#CC79A7", "#E69F00", "#56B4E9"];
const touch = matchMedia("(pointer: coarse)").matches;
const last = Math.max(0, data.places.length - 1);
let at = last;

// ---- arrays -------------------------------------------------------------------------------------
function unpack(packed) {
  if (!packed.values) {
    const bytes = Uint8Array.from(atob(packed.base64), c => c.charCodeAt(0));
    packed.values = new Float32Array(bytes.buffer);
    delete packed.base64;
  }
  return packed.values;
}

// One record of an array (records, rows, columns): its rows.
function sheet(packed, k) {
  const [, rows, columns] = packed.shape, values = unpack(packed), first = k * rows * columns;
  return Array.from({length: rows}, (_, j) =>
    values.subarray(first + j * columns, first + (j + 1) * columns));
}

// One record of an array (records, columns).
function strip(packed, k) {
  const columns = packed.shape[1];
  return unpack(packed).subarray(k * columns, (k + 1) * columns);
}

const combined = (f, ...sheets) => sheets[0].map((row, j) =>
  Float32Array.from(row, (_, i) => f(...sheets.map(one => one[j][i]))));
const largest = values => values.reduce((most, v) => v > most ? v : most, -Infinity);
const least = values => values.reduce((most, v) => v < most ? v : most, Infinity);
const short = v => Number(v.toPrecision(4)).toString().replace("-", "\u2212");

// ---- text ---------------------------------------------------------------------------------------
// Text of the page's data has sub and sup alone, and five entities: it is never parsed as HTML.
const SIGNS = {"&lt;": "<", "&gt;": ">", "&amp;": "&", "&quot;": '"', "&#x27;": "'"};
const decoded = text => text.replace(/&(lt|gt|amp|quot|#x27);/g, one => SIGNS[one]);
const encoded = text => text.replace(/[<>&]/g, one => ({"<": "&lt;", ">": "&gt;", "&": "&amp;"})[one]);

function write(element, text) {
  const inside = [element];
  element.replaceChildren();
  for (const part of text.split(/(<\/?su[bp]>)/)) {
    const tag = /^<(\/?)(su[bp])>$/.exec(part);
    if (!tag) inside.at(-1).append(decoded(part));
    else if (tag[1]) inside.length > 1 && inside.pop();
    else {
      const inner = document.createElement(tag[2]);
      inside.at(-1).append(inner);
      inside.push(inner);
    }
  }
  return element;
}

// ---- charts -------------------------------------------------------------------------------------
const font = {family: getComputedStyle(document.body).fontFamily, size: 13, color: "#1c2126"};
const config = {responsive: true, displaylogo: false, displayModeBar: false};

function axis(title, more) {
  return {title: {text: title, standoff: 6}, ticks: "outside", ticklen: 4, showline: true,
    mirror: true, linecolor: "#8a949c", gridcolor: "#e6eaed", zeroline: false, automargin: true,
    fixedrange: touch, exponentformat: "power", ...more};
}

function layout(more) {
  return {font, margin: {l: 8, r: 8, t: 8, b: 8}, paper_bgcolor: "#fff", plot_bgcolor: "#fff",
    hovermode: "closest", dragmode: touch ? false : "zoom", showlegend: false, uirevision: "same",
    hoverlabel: {font: {size: 13}},
    legend: {orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: {size: 12}}, ...more};
}

// Charts are drawn when they come into view, and again when what they show has changed.
const drawn = new Map();
const seen = new IntersectionObserver(entries => entries.forEach(entry => {
  const chart = drawn.get(entry.target);
  chart.visible = entry.isIntersecting;
  if (chart.visible) draw(chart);
}), {rootMargin: "200px"});

function draw(chart) {
  if (!chart.stale) return;
  chart.stale = false;
  const {traces, layout: look} = chart.make(at);
  Plotly.react(chart.element, traces, look, config).then(() => chart.after?.());
}

function refresh(group) {
  for (const chart of drawn.values())
    if (!group || chart.group === group) {
      chart.stale = true;
      if (chart.visible) draw(chart);
    }
}

function card(parent, title, group, make, {kind = "", about = "", control = null} = {}) {
  const figure = document.createElement("figure"), head = document.createElement("figcaption"),
    element = document.createElement("div");
  figure.className = "card";
  head.append(write(document.createElement("h3"), title));
  if (about) head.append(write(document.createElement("small"), about));
  if (control) head.append(control);
  element.className = `chart ${kind}`;
  element.setAttribute("role", "img");
  element.setAttribute("aria-label", head.querySelector("h3").textContent);
  figure.append(head, element);
  $(parent).append(figure);
  const chart = {element, make, group, stale: true, visible: false, head, figure};
  drawn.set(element, chart);
  seen.observe(element);
  return chart;
}

function choice(label, options, changed) {
  const select = document.createElement("select");
  select.setAttribute("aria-label", label);
  for (const [value, text] of options) select.add(new Option(text, value));
  select.addEventListener("change", changed);
  return select;
}

// ---- the surface --------------------------------------------------------------------------------
const surface = data.surface;
const [over, long, work] = surface?.shifts ? ["", "mm", "N/mm"] : ["/V", "", "MPa"];  // of slip

// What maps show: title, unit, numbers of a record, colours, whether it has a sign, whether it goes
// on beside the contact.
const PIECES = {
  pressure: ["Pressure p<sub>n</sub>", "MPa", k => sheet(surface.fields.pressure, k), "Viridis"],
  used: [null, "MPa", k => sheet(surface.fields.used, k), "Magma"],
  traction: ["|p<sub>t</sub>|", "MPa",
    k => combined(Math.hypot, sheet(surface.fields.px, k), sheet(surface.fields.py, k)), "Magma"],
  px: ["p<sub>x</sub>", "MPa", k => sheet(surface.fields.px, k), "RdBu", true],
  py: ["p<sub>y</sub>", "MPa", k => sheet(surface.fields.py, k), "RdBu", true],
  slip: ["|s|" + over, long, k => combined(Math.hypot, sheet(surface.fields.sx, k),
    sheet(surface.fields.sy, k)), "Inferno"],
  sx: ["s<sub>x</sub>" + over, long, k => sheet(surface.fields.sx, k), "RdBu", true],
  sy: ["s<sub>y</sub>" + over, long, k => sheet(surface.fields.sy, k), "RdBu", true],
  power: ["p<sub>t</sub>\u00b7s" + over, work, k => combined((px, py, sx, sy) => -px * sx - py * sy,
    ...["px", "py", "sx", "sy"].map(name => sheet(surface.fields[name], k))), "Inferno"],
  wear: ["Wear depth w", "µm", k => sheet(surface.fields.wear, k), "Cividis"],
  friction: ["Friction in use", "", k => sheet(surface.fields.friction, k), "Inferno"],
  temperature_A: ["Temperature", "°C", k => sheet(surface.fields.temperature_A, k), "Inferno", false, true],
  temperature_B: ["Temperature", "°C", k => sheet(surface.fields.temperature_B, k), "Inferno", false, true],
};
const ranges = {};

// Least and largest over all records, or of one.
function range(name, k) {
  const key = $("own-colours").checked ? `${name} ${k}` : name;
  if (!(key in ranges)) {
    const [, , of, , signed, beside] = PIECES[name];
    const records = $("own-colours").checked ? [k] : data.places.map((_, i) => i);
    if (beside) {
      const rows = records.flatMap(of), low = least(rows.map(least));
      return ranges[key] = [low, Math.max(largest(rows.map(largest)), low + 1e-3)];
    }
    const most = largest(records.map(i => {
      const inside = sheet(surface.fields.pressure, i);
      return largest(of(i).map((row, j) =>
        largest(row.map((v, m) => inside[j][m] > 0 ? (signed ? Math.abs(v) : v) : 0))));
    }));
    ranges[key] = [signed ? -most || -1 : 0, most || 1];
  }
  return ranges[key];
}

function arrows(k, first, second, where) {
  const u = sheet(surface.fields[first], k), v = sheet(surface.fields[second], k),
    marked = sheet(surface.fields[where], k), inside = sheet(surface.fields.pressure, k),
    low = .2 * largest(inside.map(largest)), x = unpack(surface.x), y = unpack(surface.y),
    found = {x: [], y: [], angle: []}, nx = Math.max(1, Math.round(x.length / 11)),
    ny = Math.max(1, Math.round(y.length / 13));
  for (let j = Math.floor(y.length / 2) % ny; j < y.length; j += ny)
    for (let i = Math.floor(x.length / 2) % nx; i < x.length; i += nx)
      if (inside[j][i] > low && marked[j][i] > 0 && (u[j][i] || v[j][i])) {
        found.x.push(x[i]);
        found.y.push(y[j]);
        found.angle.push(Math.atan2(u[j][i], v[j][i]) * 180 / Math.PI);
      }
  return {type: "scatter", mode: "markers", x: found.x, y: found.y, hoverinfo: "skip",
    marker: {symbol: "arrow", size: 8, angle: found.angle, color: "rgba(255,255,255,.85)",
      line: {width: .7, color: "#333"}}};
}

function map(name, k, {stick = false, vectors = null} = {}) {
  const x = unpack(surface.x), y = unpack(surface.y), [, unit, of, colorscale, , beside] = PIECES[name];
  const [zmin, zmax] = range(name, k), shown = [x[0], x[x.length - 1]], up = [y[0], y[y.length - 1]];
  const unit_ = unit ? ` ${unit}` : "";
  const traces = [{type: "heatmap", x, y, z: of(k), zsmooth: "best", zmin, zmax, colorscale: data.colours[colorscale],
    hovertemplate: `x = %{x:.4g} mm<br>y = %{y:.4g} mm<br>%{z:.4g}${unit_}<extra></extra>`,
    colorbar: {thickness: 12, outlinewidth: 0, xpad: 4, exponentformat: "power",
      title: {text: unit, side: "top"}}}];
  const line = {type: "contour", x, y, hoverinfo: "skip", showscale: false};
  if (stick && Number.isFinite(unpack(surface.fields.stick)[k * x.length * y.length]))
    for (const [color, width, dash] of [["#000", 3.2, "solid"], ["#fff", 1.6, "solid"]])
      traces.push({...line, z: sheet(surface.fields.stick, k), autocontour: false,
        contours: {start: 0, end: 0, size: 1, coloring: "none"}, line: {color, width, dash}});
  // What is beyond the edge of the contact is covered, unless it goes on there.
  const edge = {...line, z: sheet(surface.fields.edge, k)};
  traces.push(beside ? {...edge, autocontour: false, line: {color: "#fff", width: 1.2},
    contours: {start: 0, end: 0, size: 1, coloring: "none"}} :
    {...edge, fillcolor: "#fff", line: {color: "#222", width: 1},
      contours: {type: "constraint", operation: ">", value: 0}});
  if (vectors) traces.push(arrows(k, ...vectors));
  const scaled = $("to-scale").checked;
  const rule = {color: "rgba(90,90,90,.55)", width: 1, dash: "dot"};
  const shapes = [
    {type: "line", xref: "x domain", x0: 0, x1: 1, y0: cut.y.value, y1: cut.y.value, line: rule},
    {type: "line", yref: "y domain", y0: 0, y1: 1, x0: cut.x.value, x1: cut.x.value, line: rule},
  ];
  return {traces, layout: layout({shapes, uirevision: String(scaled),
    xaxis: axis("x (mm)", {range: shown, showgrid: false, nticks: 5, constrain: "domain"}),
    yaxis: axis("y (mm)", {range: up, showgrid: false, constrain: "domain",
      ...(scaled ? {scaleanchor: "x", scaleratio: 1} : {})})})};
}

const cut = {x: {value: 0}, y: {value: 0}};

function lines(k, along, places, at_, of) {
  const traces = [];
  const add = (name, values, style, more) => traces.push({type: "scatter", mode: "lines", name,
    x: places, y: values, line: style, hovertemplate: `${along} = %{x:.4g} mm<br>%{y:.4g} MPa`, ...more});
  const pressure = of("pressure", k);
  if (k > 0) add(`p<sub>n</sub>, ${told(0)}`, of("pressure", 0), {color: GREY, width: 1, dash: "dot"});
  add("p<sub>n</sub>", pressure, {color: GREY, width: 2});
  if (!surface.frictionless) {
    const [bx, by] = surface.bounds, same = Math.abs(bx - by) <= 1e-9 * bx;
    const names = surface.isotropic ? ["±µ p<sub>n</sub>"] : same ? ["reach of either"] :
      ["reach of p<sub>x</sub>", "reach of p<sub>y</sub>"];
    names.forEach((name, m) => {
      const style = {color: same ? "#333" : COLOURS[m], width: 1, dash: "dash"};
      const group = {legendgroup: name, hoverinfo: "skip", hovertemplate: null};
      add(name, pressure.map(p => surface.bounds[m] * p), style, group);
      add(name, pressure.map(p => -surface.bounds[m] * p), style, {...group, showlegend: false});
    });
    add("p<sub>x</sub>", of("px", k), {color: BLUE, width: 2});
    add("p<sub>y</sub>", of("py", k), {color: VERMILLION, width: 2});
  }
  return {traces, layout: layout({showlegend: true, xaxis: axis(`${along} (mm)`),
    yaxis: axis("MPa", {zeroline: true, zerolinecolor: "#8a949c"})})};
}

function cutCard(along, across) {
  const places = unpack(surface[across]), middle = Math.floor(places.length / 2);
  const row = document.createElement("div"), slider = document.createElement("input"),
    output = document.createElement("output"), label = document.createElement("label");
  const chart = card("cuts", `Tractions along ${along}`, "cut", k => lines(k, along,
    unpack(surface[along]), at, (name, record) => {
      const rows = sheet(surface.fields[name], record), m = slider.valueAsNumber;
      return along === "x" ? rows[m] : Float32Array.from(rows, one => one[m]);
    }));
  slider.type = "range";
  slider.id = `cut-${across}`;
  Object.assign(slider, {min: 0, max: places.length - 1, step: 1, value: middle});
  label.htmlFor = slider.id;
  row.className = "cut";
  row.append(label, slider);
  chart.figure.append(row);
  const moved = () => {
    cut[across].value = places[slider.valueAsNumber];
    const text = `${across} = ${short(cut[across].value)} mm`;
    label.textContent = `at ${text}`;
    slider.setAttribute("aria-valuetext", text);
  };
  slider.addEventListener("input", () => { moved(); refresh("cut"); refresh("map"); });
  moved();
}

function surfaceCards() {
  if (!surface) { $("surface").hidden = true; return; }
  if (data.line) {
    $("map-controls").hidden = true;
    lineCards();
    return;
  }
  const x = unpack(surface.x), y = unpack(surface.y),
    ratio = (y[y.length - 1] - y[0]) / (x[x.length - 1] - x[0]);
  $("to-scale").checked = ratio > .4 && ratio < 2.5;
  const told_ = () => $("map-told").textContent = $("to-scale").checked ? "" :
    "x and y are drawn to scales of their own; arrows show true directions.";
  told_();
  $("to-scale").addEventListener("change", () => { told_(); refresh("map"); });
  cutCard("x", "y");
  cutCard("y", "x");
  card("maps", PIECES.pressure[0], "map", k => map("pressure", k), {kind: "map"});
  if (!surface.frictionless) {
    const which = choice("what of the traction", [
      ["used", surface.isotropic ? "|pₜ|/µ" : "‖pₜ‖µ ≤ pₙ"],
      ["traction", "|pₜ|"], ["px", "along x"], ["py", "along y"]], () => refresh("map"));
    card("maps", "Traction on A", "map", k => map(which.value, k, {stick: true,
      vectors: ["px", "py", "pressure"]}), {kind: "map", control: which});
    if (surface.moved) {
      const what = choice("what of the slip", [["slip", "|s|" + over], ["sx", "along x"],
        ["sy", "along y"], ["power", (over ? "power" : "work") + " pₜ·s" + over]], () => refresh("map"));
      card("maps", "Slip of A over B", "map", k => map(what.value, k, {stick: true,
        vectors: ["sx", "sy", "sliding"]}), {kind: "map", control: what});
    }
  }
  if (surface.worn) card("maps", PIECES.wear[0], "map", k => map("wear", k), {kind: "map"});
  if (surface.fields.friction)
    card("maps", PIECES.friction[0], "map", k => map("friction", k, {stick: true}),
      {kind: "map", about: "over that at rest"});
  if (surface.fields.temperature_A) {
    const of = choice("of which body", [["temperature_A", "of A"], ["temperature_B", "of B"]],
      () => refresh("map"));
    card("maps", PIECES.temperature_A[0], "map", k => map(of.value, k), {kind: "map", control: of});
  }
}

function lineCards() {
  const x = unpack(surface.x), one = (name, k) => sheet(surface.fields[name], k)[0];
  card("cuts", "Pressure and traction along x", "map", k => lines(k, "x", x, at, one));
  const course = (title, unit, names, beside) => card("cuts", title, "map", k => {
    const inside = one("pressure", k);
    const traces = names.map(([field, name], m) => ({type: "scatter", mode: "lines", name, x,
      y: one(field, k).map((v, i) => beside || inside[i] > 0 ? v : NaN), line: {color: COLOURS[m], width: 2},
      hovertemplate: `x = %{x:.4g} mm<br>%{y:.4g} ${unit}`}));
    return {traces, layout: layout({showlegend: true, xaxis: axis("x (mm)"), yaxis: axis(unit)})};
  });
  if (surface.moved) course("Slip of A over B", "", [["sx", "s<sub>x</sub>/V"], ["sy", "s<sub>y</sub>/V"]]);
  if (surface.worn) course("Wear depth of both bodies", "µm", [["wear", "w"]]);
  if (surface.fields.friction) course("Friction in use, over that at rest", "", [["friction", "p<sub>t</sub>"]]);
  if (surface.fields.temperature_A)
    course("Temperature", "°C", [["temperature_A", "of A"], ["temperature_B", "of B"]], true);
}

function profileCard() {
  if (!data.profiles) return;
  const y = unpack(data.profiles.y), NAMES = {A: "body A", B: "body B", both: "both together"};
  const row = (name, k) => unpack(data.profiles.lines[name]).subarray(k * y.length, (k + 1) * y.length);
  card("cuts", "Depth worn off across the track", "place", k => {
    const traces = [], total = "both" in data.profiles.lines ? "both" : Object.keys(data.profiles.lines)[0];
    data.places.forEach((_, m) => traces.push({type: "scatter", mode: "lines", x: y, y: row(total, m),
      name: "other records", legendgroup: "others", showlegend: m === (k ? 0 : 1), hovertemplate:
      `${told(m)}<br>%{y:.4g} µm<extra></extra>`, line: {color: "#c3cad0", width: 1}}));
    Object.keys(data.profiles.lines).forEach((name, m) => traces.push({type: "scatter", mode: "lines",
      name: NAMES[name], x: y, y: row(name, k), hovertemplate: "y = %{x:.4g} mm<br>%{y:.4g} µm",
      line: {width: 2, color: name === "both" ? GREY : COLOURS[m], dash: name === "B" ? "dash" : "solid"}}));
    return {traces, layout: layout({showlegend: true, xaxis: axis("y (mm)"),
      yaxis: axis("depth (µm)", {autorange: "reversed"})})};
  });
}

// ---- below the surface --------------------------------------------------------------------------
function stressCard() {
  if (!data.stress.length) { hide("stress"); return; }
  const COMPONENTS = [["von Mises", "von Mises"], ...["xx", "yy", "zz", "xy", "xz", "yz"].map(c =>
    [c, `σ ${c}`])];
  const planes = [...new Set(data.stress.map(one => one.plane))];
  const of = (plane, body) => data.stress.find(one => one.plane === plane && one.body === body);
  for (const one of planes) $("plane").add(new Option(one, one));
  for (const [value, text] of COMPONENTS) $("component").add(new Option(text, value));
  const bodies = () => {
    const plane = $("plane").value, before = $("body").value,
      there = data.stress.filter(one => one.plane === plane), depth = there[0].axes[1] === "depth";
    $("body").replaceChildren();
    if (there.length > 1 && depth) $("body").add(new Option("A above B", "both"));
    for (const one of there) $("body").add(new Option(one.body, one.body));
    if ([...$("body").options].some(option => option.value === before)) $("body").value = before;
  };
  bodies();
  const chart = card("stress", "Stress", "stress", k => {
    const plane = $("plane").value, which = $("body").value, name = $("component").value;
    const shown = which === "both" ? [of(plane, "A"), of(plane, "B")] : [of(plane, which)];
    const [first, second] = shown[0].axes, deep = second === "depth", signed = name !== "von Mises";
    const x = strip(shown[0].first, k), up = which === "both";
    let y = [], z = [];
    const most = {value: 0};
    shown.forEach((one, m) => {
      const rows = sheet(one.components[name], k), places = Array.from(strip(one.second, k));
      rows.forEach((row, j) => row.forEach((v, i) => {
        if (Math.abs(v) > Math.abs(most.value))
          Object.assign(most, {value: v, x: x[i], depth: places[j], body: one.body});
      }));
      // z points into A: its depths count upwards where both bodies are shown.
      const levels = places.map((d, j) => [deep ? (up && one.body === "A" ? d : -d) : d, rows[j]]);
      y = y.concat(levels.map(level => level[0]));
      z = z.concat(levels.map(level => level[1]));
    });
    const order = y.map((_, j) => j).sort((p, q) => y[p] - y[q]);
    // Both bodies have a row at the surface: they are drawn as close as no eye can tell.
    y = order.map((j, m) => y[j] + (up && y[j] === 0 ? 1e-6 * (m && y[order[m - 1]] === 0 ? 1 : -1) : 0));
    z = order.map(j => z[j]);
    const limit = largest(shown.map(one => $("own-colours").checked ?
      largest(sheet(one.components[name], k).map(row => largest(row.map(Math.abs)))) :
      largest(unpack(one.components[name]).map(Math.abs))));
    const size = nice(limit / (signed ? 12 : 25));
    const top = Math.ceil(limit / size) * size;
    const traces = [{type: "contour", x, y, z, zmin: signed ? -top : 0, zmax: top, autocontour: false,
      colorscale: data.colours[signed ? "RdBu" : "Plasma"], line: {width: .4, color: "rgba(0,0,0,.35)"},
      contours: {start: signed ? -top : 0, end: top, size}, colorbar: {thickness: 12, outlinewidth: 0,
      title: {text: "MPa", side: "top"}}, hovertemplate: `${first} = %{x:.4g} mm<br>` +
      `${deep ? "depth" : second} = %{text} mm<br>%{z:.4g} MPa<extra></extra>`,
      text: y.map(v => Array(x.length).fill(short(deep ? Math.abs(v) : v)))},
      {type: "scatter", mode: "markers", x: [most.x], hoverinfo: "skip",
        y: [deep ? (up && most.body === "A" ? most.depth : -most.depth) : most.depth],
        marker: {size: 9, color: "#fff", line: {color: "#000", width: 1.2}}, cliponaxis: false}];
    const place = `${first} = ${short(most.x)} mm, ${second} = ${short(most.depth)} mm`;
    write(chart.head.querySelector("h3"),
      `${symbol(name)} on ${encoded(plane)}${up ? ", A above B" : `, body ${encoded(which)}`}${now()}`);
    chart.head.querySelector("small").textContent =
      `largest ${short(most.value)} MPa in ${most.body} at ${place}` +
      (most.depth === 0 && deep ? "; values at the surface depend on the mesh" : "");
    const ends = largest(y.map(Math.abs));
    const ticks = deep ? {tickvals: steps(ends, up), ticktext: steps(ends, up).map(v => short(Math.abs(v)))} : {};
    return {traces, layout: layout({uirevision: plane + which,
      xaxis: axis(`${first} (mm)`, {showgrid: false, range: [x[0], x[x.length - 1]], constrain: "domain"}),
      yaxis: axis(deep ? "depth (mm)" : `${second} (mm)`, {showgrid: false, ...ticks,
        range: [y[0], y[y.length - 1]], constrain: "domain",
        ...(deep || $("to-scale").checked ? {scaleanchor: "x", scaleratio: 1} : {})}),
      shapes: up ? [{type: "line", x0: x[0], x1: x[x.length - 1], y0: 0, y1: 0,
        line: {width: 1, color: "#000"}}] : []})};
  }, {kind: "big", about: " "});
  depthCard(of);
  for (const id of ["plane", "body", "component"])
    $(id).addEventListener("change", () => { if (id === "plane") bodies(); refresh("stress"); });
}

// Stress over the depth, at a place along the plane.
function depthCard(of) {
  const slider = document.createElement("input"), label = document.createElement("label"),
    row = document.createElement("div");
  const chart = card("stress", "Over the depth", "stress", k => {
    const plane = $("plane").value, which = $("body").value, name = $("component").value;
    const shown = (which === "both" ? ["A", "B"] : [which]).map(body => of(plane, body));
    const [first, second] = shown[0].axes, places = strip(shown[0].first, k);
    chart.figure.hidden = second !== "depth";
    if (chart.plane !== plane) {  // a new plane is looked at in its middle
      chart.plane = plane;
      slider.max = places.length - 1;
      slider.value = Math.floor(places.length / 2);
    }
    const m = slider.valueAsNumber, place = `${first} = ${short(places[m])} mm`;
    label.textContent = `at ${place}`;
    slider.setAttribute("aria-valuetext", place);
    const traces = shown.map(one => ({type: "scatter", mode: "lines", name: `body ${one.body}`,
      x: sheet(one.components[name], k).map(values => values[m]), y: strip(one.second, k),
      line: {width: 2, color: one.body === "A" ? BLUE : VERMILLION, dash: one.body === "A" ? "solid" : "dash"},
      hovertemplate: "%{x:.4g} MPa<br>depth = %{y:.4g} mm"}));
    return {traces, layout: layout({showlegend: true, uirevision: plane + name,
      xaxis: axis(`${symbol(name)} (MPa)`, {zeroline: true, zerolinecolor: "#8a949c"}),
      yaxis: axis("depth (mm)", {autorange: "reversed"})})};
  }, {kind: "big"});
  slider.type = "range";
  slider.id = "cut-depth";
  label.htmlFor = slider.id;
  row.className = "cut";
  row.append(label, slider);
  chart.figure.append(row);
  slider.addEventListener("input", () => { chart.stale = true; draw(chart); });
}

const symbol = name => name === "von Mises" ? "σ<sub>vM</sub>" : `σ<sub>${name}</sub>`;

function nice(step) {
  const power = 10 ** Math.floor(Math.log10(step || 1));
  return [1, 2, 2.5, 5, 10].map(m => m * power).find(s => s >= step * .999);
}

function steps(end, both) {
  const step = nice(end / 4), found = [];
  for (let v = both ? -Math.floor(end / step) * step : -Math.floor(end / step) * step;
    v <= (both ? end : 0) + 1e-9 * end; v += step) found.push(Math.abs(v) < 1e-9 * step ? 0 : v);
  return found;
}

// ---- the course ---------------------------------------------------------------------------------
function courseCards() {
  if (!data.charts.length) { hide("charts"); return; }
  const x = unpack(data.course), places = data.places.length ? unpack(data.at) : [];
  // Patches follow each other in no order: their points are not joined.
  const mode = data.along.sequence ? x.length > 60 ? "lines" : "lines+markers" : "markers";
  const name = data.along.name + (data.along.unit ? ` (${data.along.unit})` : "");
  write($("along-told"), data.along.name);
  $("aside").hidden = !data.charts.some(one => one.aside);
  for (const one of data.charts) {
    const chart = card(one.aside ? "charts-aside" : "charts", one.title, "course", k => {
      const traces = one.lines.map((line, m) => ({type: "scatter", mode,
        name: line.name, x, y: unpack(line.values), line: {color: COLOURS[m % COLOURS.length], width: 1.8,
        dash: m >= COLOURS.length ? "dash" : "solid"}, marker: {size: data.along.sequence ? 4 : 9},
        ...(line.bars ? {error_y: {type: "data", array: unpack(line.bars), thickness: 1, width: 2}} : {}),
        hovertemplate: `${data.along.symbol} = %{x}<br>%{y:.5g}`}));
      one.lines.forEach(({measured}, m) => measured && traces.push({type: "scatter", mode: "markers",
        name: measured.name, x: unpack(measured.x), y: unpack(measured.y),
        marker: {size: 8, symbol: "x", color: COLOURS[m % COLOURS.length]},
        hovertemplate: `${data.along.symbol} = %{x}<br>%{y:.5g}`}));
      const shapes = places.length > 1 ? [{type: "line", yref: "paper", y0: 0, y1: 1, x0: places[k],
        x1: places[k], line: {color: "#56616b", width: 1, dash: "dot"}}] : [];
      const log = $("logarithmic").checked;
      return {traces, layout: layout({shapes, showlegend: traces.length > 1, uirevision: String(log),
        xaxis: axis(name, {type: log ? "log" : "linear", nticks: 6, ...(data.along.sequence ? {} : {dtick: 1}),
          ...(log ? {} : {separatethousands: true, exponentformat: "none", rangemode: "tozero"})}),
        yaxis: axis(one.label)})};
    });
    chart.after = () => {
      if (chart.clicks || places.length < 2) return;
      chart.clicks = true;
      chart.element.on("plotly_click", event => {
        const there = event.points[0].x;
        const distances = Array.from(places, v => Math.abs(v - there));
        show(distances.indexOf(least(distances)));
      });
    };
  }
  $("logarithmic").addEventListener("change", () => refresh("course"));
}

// ---- the place ----------------------------------------------------------------------------------
const told = k => `${data.along.symbol} = ${data.places[k]}${data.along.unit ? ` ${data.along.unit}` : ""}`;
const now = () => data.places.length > 1 ? `, ${told(at)}` : "";
const plainly = text => write(document.createElement("p"), text).textContent;

function hide(of) {
  for (const element of document.querySelectorAll(`[data-of=${of}]`)) element.hidden = true;
}

function rows() {
  const found = (data.numbers[at] || []).map(({name, value, unit, about}) => {
    const row = document.createElement("tr");
    for (const text of [name, value, unit, about]) {
      const cell = document.createElement("td");
      cell.textContent = text;
      row.append(cell);
    }
    return row;
  });
  $("rows").replaceChildren(...found);
  write($("numbers-told"), data.places.length ? `of the record at ${told(at)}` : "of the last record");
}

function show(k) {
  at = Math.min(Math.max(k, 0), last);
  $("at").value = at;
  if (data.places.length) {
    $("at").setAttribute("aria-valuetext", plainly(told(at)));
    write($("at-told"), told(at));
  }
  rows();
  refresh();
}

surfaceCards();
profileCard();
stressCard();
courseCards();
$("place").hidden = data.places.length < 2;
write(document.querySelector("#place label"), `Stored ${data.along.name}`);
$("at").max = last;
$("own-colours").addEventListener("change", () => { refresh("map"); refresh("stress"); });
let asked = 0;
$("at").addEventListener("input", () => {
  cancelAnimationFrame(asked);
  asked = requestAnimationFrame(() => show($("at").valueAsNumber));
});
addEventListener("beforeprint", () => { for (const chart of drawn.values()) draw(chart); });
show(last);
})();
