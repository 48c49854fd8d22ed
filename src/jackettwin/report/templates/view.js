/* A structure to turn, colour and set in motion: one widget for the report, `jackettwin view` and the window.

   show(root, D) makes the picture and its controls inside root; D is what view_document() of
   report/view/page.py returns. Colours are the page's own (tokens.css). What is shown stands in asked, as
   an address holds it, and keep is told what changes of it; null is what is shown at first. */
export function show(root, D, asked = new Map(), keep = () => {}) {
  const make = (tag, more = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), more);
    made.append(...inside);
    return made;
  };
  const parts = {};
  const part = (id, element) => (parts[id] = element);
  const $ = id => parts[id];
  const titled = (id, text, element, note) => make("label", {}, make("b", {}, text), " ",
    ...(note ? [part(note, make("span"))] : []), part(id, element));
  const slider = (low, high, step, value) => Object.assign(make("input", {type: "range"}), {min: low, max: high, step, value});
  const box = (id, text, key) => make("label", {className: "tick"},
    part(id, make("input", {type: "checkbox", checked: true})), " ",
    ...(key ? [make("i", {className: `key ${key}`})] : []), text);
  const canvas = make("canvas", {tabIndex: 0});
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${D.title}, drawn in space: arrow keys turn it, space stops it`);
  const tip = make("div", {className: "tip", hidden: true});
  const others_there = [...new Set(D.others.map(o => o.kind))].sort();
  const time = slider(0, 1, 0.001, 0);
  time.setAttribute("aria-label", "Time");
  const side = make("div", {className: "controls"},
    titled("quantity", "Colour", make("select")),
    make("div", {className: "bar"}, part("scale", make("canvas", {width: 232, height: 14})), part("ticks", make("div"))),
    titled("motion", "Motion", make("select"), "clock"),
    part("note", make("p", {className: "fact"})),
    make("div", {className: "row"}, part("play", make("button", {type: "button"}, "Pause")), part("time", time)),
    titled("size", "Drawn", slider(-1, 1, 0.01, 0), "factor"),
    titled("speed", "Speed", slider(-1, 1.3, 0.01, 0), "pace"),
    make("fieldset", {}, make("legend", {}, "Show"),
      box("water", "sea level and mud line"),
      ...(D.growth.some(t => t > 0) ? [box("growth", "marine growth", "growth")] : []),
      ...(D.flooded.some(f => f) ? [box("flooded", "flooded members", "flooded")] : []),
      ...(D.sensors.length ? [box("sensors", "sensors", "sensors")] : []),
      ...(D.motions.some(o => o.measured) ? [box("measured", "measured shape", "measured")] : []),
      box("dimensions", "dimensions", "dimensions"),
      box("ghost", "position at rest", "ghost"),
      ...others_there.map(kind => make("p", {className: "fact"}, make("i", {className: `key ${kind.replace(" ", "-")}`}), `${kind}s`))),
    make("p", {className: "help"}, "Drag to turn, click and wheel to zoom, shift-drag to move, double-click to look from the start again. Point at a member to read it."));
  root.classList.add("structure");
  root.append(make("div", {className: "picture"}, canvas, tip), side);
  const pen = canvas.getContext("2d");
  let look = {};
  function looks() {
    const said = getComputedStyle(root), rgb = name => {
      pen.fillStyle = said.getPropertyValue(`--${name}`);
      const hex = pen.fillStyle;  // of six digits, however it is written
      return [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
    };
    look = {paper: rgb("paper"), ink: said.getPropertyValue("--ink"), quiet: said.getPropertyValue("--quiet"),
      line: said.getPropertyValue("--line"), measured: said.getPropertyValue("--green"), sensor: said.getPropertyValue("--vermillion"),
      sea: rgb("blue"), ground: rgb("orange")};
  }
  looks();
  // Cividis (Nuñez, Anderton & Renslow 2018): even in grey, the same to colour-blind eyes
  const CIVIDIS = [[0,34,78],[18,53,112],[59,73,108],[87,93,109],[112,113,115],[138,134,120],[165,156,116],[195,179,105],[225,204,85],[254,232,56]];
  const n = D.nodes.length / 3, m = D.start.length;
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  D.nodes.forEach((v, i) => { const k = i % 3; low[k] = Math.min(low[k], v); high[k] = Math.max(high[k], v); });
  const centre = low.map((v, k) => 0.5 * (v + high[k])), height = high[2] - low[2];
  const reach = 0.75 * Math.max(high[0] - low[0], high[1] - low[1], 0.2 * height);
  const home = {turn: -0.62, tilt: 0.2, zoom: 1, x: 0, y: 0};
  const eye = Object.assign({}, home), linked = new Set();
  const state = {frame: 0, playing: true, last: 0, motion: null, quantity: null, gone: false};
  const moving = {log: false, from_zero: true};
  const colours = [...D.quantities,
    ...(D.motions.some(o => o.load) ? [{...moving, name: "wave load, mean of member", unit: "kN/m", frames: true}] : []),
    ...(D.motions.some(o => o.stress) ? [{...moving, name: "stress, modes at 0.1 m", unit: "MPa", stress: true}] : [])];
  let at = D.nodes.slice(), scale = 1, size = [1, 1], pixel = 1, screen = [], hover = -1;

  const BOXES = ["water", "growth", "flooded", "sensors", "measured", "dimensions", "ghost"].filter($);
  function shown(id) { const box = $(id); return box ? box.checked : false; }

  /* ---- projection: orthographic, z up ---- */
  function project(x, y, z) {
    const dx = x - centre[0], dy = y - centre[1], dz = z - centre[2];
    const c = Math.cos(eye.turn), s = Math.sin(eye.turn), ct = Math.cos(eye.tilt), st = Math.sin(eye.tilt);
    const right = dx * c + dy * s, into = -dx * s + dy * c;
    return [size[0] / 2 + eye.x + scale * right, size[1] / 2 + eye.y - scale * (dz * ct + into * st), into * ct - dz * st];
  }

  /* ---- motion ---- */
  function wave(x, y) {
    const w = state.motion && state.motion.wave;
    if (!w) { return 0; }
    const along = x * Math.cos(w.direction_rad) + y * Math.sin(w.direction_rad);
    const phase = 2 * Math.PI * (state.frame / state.motion.q.length - along / w.length_m);
    return 0.5 * w.height_m * Math.cos(phase);
  }
  function factor() {
    return state.motion ? 0.08 * height * Math.pow(10, Number($("size").value)) : 0;
  }
  function move() {
    const mo = state.motion;
    at = D.nodes.slice();
    if (!mo) { return; }
    const k = Math.floor(state.frame), next = (k + 1) % mo.q.length, part = state.frame - k;
    mo.shapes.forEach((shape, j) => {
      const q = factor() * (mo.q[k][j] * (1 - part) + mo.q[next][j] * part);
      for (let i = 0; i < at.length; i++) { at[i] += q * shape[i]; }
    });
  }

  /* ---- colour ---- */
  function values() {
    if (state.quantity.stress) { return stressed(state.motion, Math.floor(state.frame)); }
    if (state.quantity.frames) {
      const mo = state.motion && state.motion.load ? state.motion : D.motions.find(o => o.load);
      return mo.load[mo === state.motion ? Math.floor(state.frame) : 0];
    }
    return state.quantity.values;
  }
  function stressed(mo, frame) {  // the larger of an element's ends, of a mode where it moves by 0.1 m
    if (!mo || !mo.stress) { return Array(m).fill(null); }
    const size = mo.largest_m || 0.1, sum = k => mo.stress.reduce((all, shape, j) => all + mo.q[frame][j] * shape[k], 0);
    const end = k => Math.abs(sum(k)) + Math.hypot(sum(k + 1), sum(k + 2));
    return Array.from({length: m}, (_, e) => size * Math.max(end(6 * e), end(6 * e + 3)));
  }
  function mapped(v) { return state.quantity.log ? Math.log10(v) : v; }
  function colour(v) {
    if (v === null || !isFinite(mapped(v))) { return [190, 190, 190]; }
    const q = state.quantity, span = q.high - q.low || 1;
    const t = Math.min(1, Math.max(0, (mapped(v) - q.low) / span)) * (CIVIDIS.length - 1);
    const k = Math.min(Math.floor(t), CIVIDIS.length - 2), part = t - k;
    return CIVIDIS[k].map((c, i) => c + part * (CIVIDIS[k + 1][i] - c));
  }
  function css(c, fade) { return `rgb(${c.map((v, k) => Math.round(v + fade * (look.paper[k] - v))).join(",")})`; }
  function number(v) {
    const a = Math.abs(v);
    return a !== 0 && (a < 0.01 || a >= 1e5) ? v.toExponential(1) : String(Number(v.toPrecision(3)));
  }
  function bar() {
    const q = state.quantity, c = $("scale"), p = c.getContext("2d");
    for (let i = 0; i < c.width; i++) {
      const v = q.low + (q.high - q.low) * i / (c.width - 1);
      p.fillStyle = css(colour(q.log ? Math.pow(10, v) : v), 0);
      p.fillRect(i, 0, 1, c.height);
    }
    const ends = [0, 0.5, 1].map(t => q.low + t * (q.high - q.low)).map(v => q.log ? Math.pow(10, v) : v);
    $("ticks").replaceChildren(...ends.map(v => make("span", {}, number(v))));
  }

  /* ---- drawing ---- */
  function line(a, b, width, style) {
    pen.beginPath(); pen.moveTo(a[0], a[1]); pen.lineTo(b[0], b[1]);
    pen.lineWidth = width; pen.strokeStyle = style; pen.stroke();
  }
  function plane(z, rgb, alpha, cells, lift) {
    const half = (lift ? 1.6 : 1) * reach, x0 = centre[0] - half, y0 = centre[1] - half, d = 2 * half / cells;
    const point = (i, j) => { const x = x0 + i * d, y = y0 + j * d; return project(x, y, z + (lift ? lift(x, y) : 0)); };
    for (let i = 0; i < cells; i++) {
      for (let j = 0; j < cells; j++) {
        pen.beginPath();
        [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].forEach(([a, b], k) => {
          const p = point(a, b); if (k) { pen.lineTo(p[0], p[1]); } else { pen.moveTo(p[0], p[1]); }
        });
        pen.fillStyle = `rgba(${rgb},${alpha})`; pen.fill();
      }
    }
    pen.strokeStyle = `rgba(${rgb},0.75)`; pen.lineWidth = 1.2;
    pen.beginPath();
    const edge = [];
    for (let k = 0; k < cells; k++) { edge.push([k, 0]); }
    for (let k = 0; k < cells; k++) { edge.push([cells, k]); }
    for (let k = cells; k > 0; k--) { edge.push([k, cells]); }
    for (let k = cells; k > 0; k--) { edge.push([0, k]); }
    edge.forEach(([a, b], k) => { const p = point(a, b); if (k) { pen.lineTo(p[0], p[1]); } else { pen.moveTo(p[0], p[1]); } });
    pen.closePath(); pen.stroke();
    const label = point(cells, 0);
    pen.fillStyle = `rgb(${rgb})`; pen.font = "12px system-ui, sans-serif"; pen.textAlign = "left";
    const said = z === 0 ? "sea level" : `mud line ${z < 0 ? "−" : "+"}${Math.abs(z).toFixed(1)} m`;
    const room = size[0] - pen.measureText(said).width - 4;  // on a phone the name would be cut off
    pen.fillText(said, Math.min(label[0] + 6, room), label[1] + (label[0] + 6 > room ? 18 : 4));
  }
  function shade(c, share) {  // towards black or, beyond 1, white
    return c.map(v => share < 1 ? share * v : v + (share - 1) * (255 - v));
  }
  function tube(a, b, width, c, fade) {  // the colour of its middle, lit from above left, as a tube is
    const along = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (along < 1 || width < 3) { return css(c, fade); }
    const side = b[0] - a[0] > a[1] - b[1] ? 1 : -1;  // which of its sides is lit
    const x = side * 0.5 * width * (b[1] - a[1]) / along, y = -side * 0.5 * width * (b[0] - a[0]) / along;
    const across = pen.createLinearGradient(a[0] + x, a[1] + y, a[0] - x, a[1] - y);
    [[0, 0.86], [0.28, 1.3], [0.55, 1], [1, 0.62]].forEach(([at, share]) => across.addColorStop(at, css(shade(c, share), fade)));
    return across;
  }
  function member(e, now) {
    const a = screen[D.start[e]], b = screen[D.end[e]], width = Math.max(1.4, D.diameter[e] * scale);
    pen.lineCap = "butt";  // outlines along the sides only: pieces of one tube run on
    if (shown("growth") && D.growth[e] > 0) {
      line(a, b, width + Math.max(3, 2 * D.growth[e] * scale), "rgba(139,168,112,0.75)");
    }
    const deep = (0.5 * (a[2] + b[2]) / (0.6 * height)), fade = Math.min(0.35, Math.max(0, 0.12 + 0.35 * deep));
    pen.lineCap = "butt";  // outlines along the sides only: pieces of one tube run on
    line(a, b, width + (e === hover ? 5 : 1.6), e === hover ? look.sensor : css([60, 60, 60], fade));
    pen.lineCap = width < 8 ? "round" : "butt";  // round ends of a wide tube would cover its neighbour when bent
    line(a, b, width, tube(a, b, width, colour(now[e]), fade));
    if (shown("flooded") && D.flooded[e]) {
      pen.lineCap = "butt"; pen.setLineDash([4, 8]); line(a, b, Math.max(1, 0.3 * width), "#56b4e9"); pen.setLineDash([]);
    }
  }
  function draw() {
    if (!state.quantity) { return; }
    pen.setTransform(pixel, 0, 0, pixel, 0, 0);
    pen.clearRect(0, 0, size[0], size[1]);
    pen.lineCap = "round";
    move();
    screen = [];
    for (let i = 0; i < n; i++) { screen.push(project(at[3 * i], at[3 * i + 1], at[3 * i + 2])); }
    const order = [...Array(m).keys()].sort((p, q) => depth(q) - depth(p));
    const wet = e => { const i = 3 * D.start[e], j = 3 * D.end[e]; return 0.5 * (at[i + 2] + at[j + 2]) < wave(at[i], at[i + 1]); };
    const now = values(), seen = shown("water"), above = eye.tilt >= 0;
    if (seen && above) { plane(D.mud_z, look.ground, 0.1, 1); }
    if (state.motion && shown("ghost")) { ghost(); }
    order.filter(e => wet(e) === above).forEach(e => member(e, now));
    if (seen) { plane(0, look.sea, 0.13, state.motion && state.motion.wave ? 28 : 1, state.motion && state.motion.wave ? wave : null); }
    order.filter(e => wet(e) !== above).forEach(e => member(e, now));
    if (seen && !above) { plane(D.mud_z, look.ground, 0.1, 1); }
    others();
    bodies();
    measured();
    if (shown("dimensions")) { measures(); }
    axes();
  }
  function depth(e) { return screen[D.start[e]][2] + screen[D.end[e]][2]; }
  function ghost() {
    pen.setLineDash([3, 4]);
    for (let e = 0; e < m; e++) {
      const a = 3 * D.start[e], b = 3 * D.end[e];
      line(project(D.nodes[a], D.nodes[a + 1], D.nodes[a + 2]), project(D.nodes[b], D.nodes[b + 1], D.nodes[b + 2]), 1, look.line);
    }
    pen.setLineDash([]);
  }
  function measured() {  // where the sensors went: beside the model's own place in the same phase
    const mo = state.motion;
    if (!mo || !mo.measured || !shown("measured")) { return; }
    const k = Math.floor(state.frame), next = (k + 1) % mo.q.length, part = state.frame - k;
    mo.measured.places.forEach((place, i) => {
      const moved = [0, 1, 2].map(c => place.at[c] + mo.measured.shapes.reduce((sum, shape, j) =>
        sum + factor() * shape[3 * i + c] * (mo.q[k][j] * (1 - part) + mo.q[next][j] * part), 0));
      const p = project(...moved), own = carried(place);
      line(own, p, 1.5, look.measured);
      pen.beginPath(); pen.arc(p[0], p[1], 5, 0, 2 * Math.PI); pen.fillStyle = look.measured; pen.fill();
    });
  }
  function carried(item) {
    const i = 3 * item.node;
    return project(...[0, 1, 2].map(k => item.at[k] + at[i + k] - D.nodes[i + k]));
  }
  const OTHERS = {cable: [2, "#0072b2", []], spring: [3, "#cc79a7", [3, 3]], "rigid link": [2, "#767676", [1, 4]], beam: [4, "#777777", []]};
  function others() {
    pen.lineCap = "butt";
    D.others.forEach(one => {
      const [width, style, dash] = OTHERS[one.kind];
      pen.setLineDash(dash); line(screen[one.start], screen[one.end], width, style); pen.setLineDash([]);
    });
  }
  function bodies() {
    D.masses.forEach(body => {
      const p = carried(body), i = body.node;
      line(screen[i], p, 1.5, look.ink);
      pen.beginPath(); pen.arc(p[0], p[1], 6, 0, 2 * Math.PI); pen.fillStyle = look.ink; pen.fill();
      if (D.masses.length > 4) { return; }
      pen.font = "11px system-ui, sans-serif"; pen.textAlign = "center";
      pen.fillText(body.text, p[0], p[1] - 12);  // over what points sideways from the node
    });
    if (!shown("sensors")) { return; }
    D.sensors.forEach(s => {
      const p = carried(s), far = s.at.map((v, k) => v + 0.07 * height * s.direction[k]);
      const tail = carried({node: s.node, at: far});
      line(p, tail, 2.5, look.sensor);
      const angle = Math.atan2(tail[1] - p[1], tail[0] - p[0]);
      pen.fillStyle = look.sensor; pen.beginPath(); pen.moveTo(tail[0], tail[1]);
      [2.6, -2.6].forEach(t => pen.lineTo(tail[0] + 9 * Math.cos(angle + t), tail[1] + 9 * Math.sin(angle + t)));
      pen.fill(); pen.fillRect(p[0] - 3.5, p[1] - 3.5, 7, 7);
    });
  }
  let labels = [];  // boxes of the dimensions that are written: what would cover one is left out
  function written(text, x, y) {
    const wide = pen.measureText(text).width, left = pen.textAlign === "right" ? x - wide : pen.textAlign === "center" ? x - wide / 2 : x;
    const box = [left - 2, y - 11, left + wide + 2, y + 3];
    if (labels.some(o => box[0] < o[2] && o[0] < box[2] && box[1] < o[3] && o[1] < box[3])) { return false; }
    labels.push(box);
    pen.fillStyle = `rgba(${look.paper},0.8)`; pen.fillRect(box[0], box[1], wide + 4, 14);
    pen.fillStyle = look.ink; pen.fillText(text, x, y);
    return true;
  }
  function span(a, b, text) {  // a line with ticks at its ends, its length beneath the middle
    const along = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (along < 1 || !written(text, 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) + 18)) { return; }
    const tx = 5 * (b[1] - a[1]) / along, ty = -5 * (b[0] - a[0]) / along;
    line(a, b, 1, look.quiet);
    [a, b].forEach(p => line([p[0] - tx, p[1] - ty], [p[0] + tx, p[1] + ty], 1, look.quiet));
  }
  function measures() {
    pen.font = "12px system-ui, sans-serif"; labels = [];
    const levels = D.dimensions.levels, ends = [levels[0], levels[levels.length - 1]];
    const high = z => project(centre[0], centre[1], z)[1];
    if (Math.cos(eye.tilt) > 0.35) {  // seen from above, heights have no length
      pen.textAlign = "right";
      const x = Math.max(76, Math.min(...screen.map(p => p[0])) - 34);
      [...ends, ...levels.slice(1, -1)].forEach(z => {
        if (written(`${z >= 0 ? "+" : "−"}${Math.abs(z).toFixed(2)} m`, x - 10, high(z) + 4)) { line([x - 6, high(z)], [x + 6, high(z)], 1, look.quiet); }
      });
      line([x, high(ends[0])], [x, high(ends[1])], 1, look.quiet);
    }
    pen.textAlign = "center";
    D.dimensions.widths.forEach(w => span(project(...w.a), project(...w.b), w.text));
    pen.textAlign = "left";
    D.dimensions.diameters.forEach(d => {
      const p = project(...d.at);
      if (written(d.text, p[0] + 38, p[1] + 4)) { line(p, [p[0] + 34, p[1]], 1, look.quiet); }
    });
  }
  function axes() {
    const o = size[0] > 480 ? [54, size[1] - 50] : [size[0] - 54, 0.32 * size[1]], c = Math.cos(eye.turn), s = Math.sin(eye.turn), ct = Math.cos(eye.tilt), st = Math.sin(eye.tilt);
    pen.font = "12px system-ui, sans-serif"; pen.textAlign = "center";
    [["x", c, s * st], ["y", s, -c * st], ["z", 0, -ct]].forEach(([name, dx, dy]) => {
      line(o, [o[0] + 34 * dx, o[1] + 34 * dy], 1.6, look.quiet);
      pen.fillStyle = look.ink; pen.fillText(name, o[0] + 44 * dx, o[1] + 44 * dy + 4);
    });
    const steps = [1, 2, 5, 10, 20, 50, 100], metres = steps.filter(v => v * scale < 130).pop() || 1, y = size[1] - 12;
    const x = size[0] > 480 ? size[0] - 20 : 20 + metres * scale;  // where the name of the mud line is not
    line([x, y], [x - metres * scale, y], 2, look.quiet);
    pen.textAlign = "right"; pen.fillText(`${metres} m`, x, y - 6);
  }

  /* ---- what goes on ---- */
  function pace() {
    const period = state.motion.step_s * state.motion.q.length;
    // slow modes as they are, fast ones at two seconds a cycle
    const natural = state.motion.cyclic && period < 2 ? 2 / period : 1;
    return Math.pow(10, Number($("speed").value)) / natural;
  }
  function told() {
    const mo = state.motion;
    $("time").value = mo ? state.frame / mo.q.length : 0;
    $("clock").textContent = mo ? `t = ${(mo.start_s + state.frame * mo.step_s).toFixed(mo.step_s < 0.01 ? 3 : 2)} s` : "";
    $("pace").textContent = mo ? `${number(pace())} × real time` : "";
  }
  function tick(time) {
    const gap = Math.min(0.1, (time - state.last) / 1000);
    if (state.gone) { return; }
    state.last = time;
    if (state.playing && state.motion) {
      state.frame = (state.frame + gap * pace() / state.motion.step_s) % state.motion.q.length;
      told(); draw();
    }
    requestAnimationFrame(tick);
  }
  function choose() {
    const index = Number($("motion").value);
    state.motion = index < 0 ? null : D.motions[index];
    state.frame = 0;
    $("note").textContent = state.motion ? state.motion.note : "";
    named(); told(); colourBy();
  }
  function named() {
    const mo = state.motion;
    $("factor").textContent = !mo ? "" : mo.largest_m ? `${number(factor() / mo.largest_m)} × as large` : `largest ${number(factor())} m`;
  }
  function colourBy() {
    const q = state.quantity = colours[Number($("quantity").value)];
    const frames = q.stress && state.motion ? state.motion.q.map((_, k) => stressed(state.motion, k)).flat() : [];
    const all = (q.stress ? frames : q.frames ? D.motions.flatMap(o => o.load ? o.load.flat() : []) : q.values).filter(v => v !== null && isFinite(q.log ? Math.log10(v) : v)).map(mapped);
    q.low = all.reduce((a, b) => Math.min(a, b), q.from_zero ? 0 : Infinity);
    q.high = all.reduce((a, b) => Math.max(a, b), -Infinity);
    bar(); draw();
  }
  function fit() {
    size = [canvas.clientWidth, canvas.clientHeight];
    pixel = window.devicePixelRatio || 1;
    canvas.width = size[0] * pixel; canvas.height = size[1] * pixel;
    scale = eye.zoom * Math.min(size[1] / (1.16 * height), size[0] / (3.1 * reach));
    draw();
  }
  function nearest(x, y) {
    let best = -1, least = 14;
    for (let e = 0; e < m; e++) {
      const a = screen[D.start[e]], b = screen[D.end[e]], dx = b[0] - a[0], dy = b[1] - a[1];
      const t = Math.min(1, Math.max(0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1)));
      const off = Math.hypot(a[0] + t * dx - x, a[1] + t * dy - y) - 0.5 * D.diameter[e] * scale;
      if (off < least) { least = off; best = e; }
    }
    return best;
  }
  function point(event) {
    hover = nearest(event.offsetX, event.offsetY);
    tip.hidden = hover < 0;
    if (hover >= 0) {
      const v = values()[hover], q = state.quantity;
      const body = D.growth[hover] > 0 ? `\nmarine growth ${(1e3 * D.growth[hover]).toFixed(0)} mm` : "";
      tip.textContent = D.text[hover].replaceAll("<br>", "\n") + `\n${q.name} ${v === null ? "–" : number(v)} ${q.unit === "–" ? "" : q.unit}` + body + (D.flooded[hover] ? "\nflooded" : "");
      tip.style.left = `${Math.min(event.offsetX + 16, size[0] - 290)}px`; tip.style.top = `${event.offsetY + 12}px`;
    }
    if (!state.playing || !state.motion) { draw(); }
  }
  let grip = null;
  function turned() {
    fit(); linked.forEach(other => other.lookFrom(eye));
    keep(Object.fromEntries(Object.keys(home).map(k => [k, eye[k] === home[k] ? null : eye[k].toFixed(2)])));
  }
  canvas.addEventListener("pointerdown", e => { canvas.focus({preventScroll: true}); grip = [e.clientX, e.clientY, e.shiftKey]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointerup", () => { grip = null; });
  canvas.addEventListener("pointermove", e => {
    if (!grip) { point(e); return; }
    const dx = e.clientX - grip[0], dy = e.clientY - grip[1];
    if (grip[2]) { eye.x += dx; eye.y += dy; }
    else { eye.turn += 0.008 * dx; eye.tilt = Math.max(-1.55, Math.min(1.55, eye.tilt + 0.008 * dy)); }
    grip = [e.clientX, e.clientY, grip[2]]; turned();
  });
  canvas.addEventListener("pointerleave", () => { hover = -1; tip.hidden = true; });
  canvas.addEventListener("wheel", e => {  // a page that is scrolled past it must not stop here
    if (document.activeElement !== canvas && !e.ctrlKey) { return; }
    e.preventDefault(); eye.zoom = Math.max(0.3, Math.min(20, eye.zoom * Math.exp(-0.0012 * e.deltaY))); turned();
  }, {passive: false});
  canvas.addEventListener("dblclick", () => { Object.assign(eye, home); turned(); });
  canvas.addEventListener("keydown", e => {
    const step = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08]}[e.key];
    if (step) { eye.turn += step[0]; eye.tilt += step[1]; turned(); e.preventDefault(); }
    if (e.key === " ") { $("play").click(); e.preventDefault(); }
  });
  function play(now) { state.playing = now; $("play").textContent = now ? "Pause" : "Play"; }
  $("play").addEventListener("click", () => {
    play(!state.playing);
    keep({play: state.playing ? null : "0", phase: state.playing ? null : Number($("time").value).toFixed(3)});
  });
  $("time").addEventListener("input", () => {
    if (!state.motion) { return; }
    state.frame = Math.min(Number($("time").value) * state.motion.q.length, state.motion.q.length - 1e-6);
    play(false); told(); draw();
    keep({play: "0", phase: $("time").value});
  });
  $("speed").addEventListener("input", told);
  $("size").addEventListener("input", () => { named(); draw(); });
  ["speed", "size"].forEach(id => $(id).addEventListener("input", () => keep({[id]: $(id).value === "0" ? null : $(id).value})));
  BOXES.forEach(id => $(id).addEventListener("change", () => { draw(); keep({[id]: shown(id) ? null : "0"}); }));

  /* ---- lists, and what the address asks for: #motion=side-side 1&quantity=1&phase=0.25&play=0 ---- */
  colours.forEach((q, k) => $("quantity").add(new Option(q.unit === "–" ? q.name : `${q.name} [${q.unit}]`, k)));
  $("motion").add(new Option("still", -1));
  [...new Set(D.motions.map(o => o.group))].forEach(group => {
    const part = document.createElement("optgroup");
    part.label = group;
    D.motions.forEach((o, k) => { if (o.group === group) { part.append(new Option(o.name, k)); } });
    $("motion").append(part);
  });
  const odd = {};  // what is asked for and is not here
  function listed(id, first) {  // by name or by number
    const said = asked.get(id), all = [...$(id).options], of = k => all.find(one => one.value === String(k)).text;
    const found = said ? all.find(one => one.text === said || one.value === said) : null;
    if (said && !found) { odd[id] = said; }
    $(id).value = found ? found.value : first;
    $(id).addEventListener("change", () => keep({[id]: $(id).value === String(first) ? null : of($(id).value)}));
  }
  listed("motion", D.motions.length ? 0 : -1);
  listed("quantity", 0);
  const numbers = {turn: [-1e3, 1e3], tilt: [-1.55, 1.55], zoom: [0.3, 20], x: [-1e4, 1e4], y: [-1e4, 1e4], phase: [0, 1], speed: [-1, 1.3], size: [-1, 1]};
  const number_of = k => {
    const said = asked.get(k), [from, to] = numbers[k], value = said ? Number(said) : Infinity;
    if (said && !(value >= from && value <= to)) { odd[k] = said; }
    return value >= from && value <= to ? value : null;
  };
  Object.keys(home).forEach(k => { eye[k] = number_of(k) ?? home[k]; });
  ["speed", "size"].forEach(k => { $(k).value = number_of(k) ?? 0; });
  BOXES.forEach(id => { $(id).checked = asked.get(id) !== "0"; });
  $("quantity").addEventListener("change", colourBy);
  $("motion").addEventListener("change", choose);
  fit(); colourBy(); choose();
  if (asked.get("play") === "0") { play(false); }
  if (number_of("phase") !== null && state.motion) { state.frame = Math.min(number_of("phase") * state.motion.q.length, state.motion.q.length - 1e-6); told(); draw(); }
  const observer = new ResizeObserver(fit);
  observer.observe(canvas);
  requestAnimationFrame(tick);
  return {
    /** What the address asks for and is not here, by name. */
    odd,
    focus() { canvas.focus({preventScroll: true}); },
    /** The colours of the page changed. */
    repaint() { looks(); colourBy(); },
    lookFrom(other) { Object.assign(eye, other); fit(); },
    /** Turn another picture as this one is turned. */
    link(other) { linked.add(other); },
    /** Stand where the motion is so many seconds after its first frame: its clock is another's. */
    stand(seconds) {
      const mo = state.motion;
      if (!mo) { return; }
      state.playing = false;
      state.frame = Math.max(0, seconds / mo.step_s) % mo.q.length;
      told(); draw();
    },
    gone() { state.gone = true; observer.disconnect(); root.replaceChildren(); },
  };
}
