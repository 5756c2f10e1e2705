// Plays the slide and shows values of the histories. Without scripts or WebGL the page keeps its pictures.
"use strict";
(async () => {
  const byId = (id) => document.getElementById(id), make = (tag, more, ...inside) => {
    const node = Object.assign(document.createElement(tag), more);
    node.append(...inside);
    return node;
  };
  const about = JSON.parse(byId("about").textContent);
  const packed = Uint8Array.from(atob(byId("data").textContent), (letter) => letter.charCodeAt(0));
  const bytes = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  const kinds = { f4: Float32Array, u2: Uint16Array, u1: Uint8Array };
  const array = (number) => {
    const [at, count, kind] = about.arrays[number];
    return new kinds[kind](bytes, at, count);
  };
  const short = (value) => (Number.isFinite(value) ? String(+value.toPrecision(4)) : "–");

  // ---- the slide ----

  const POINTS = `
    attribute vec3 place; attribute float value, body;
    uniform mat3 turn; uniform vec3 low, span, centre; uniform vec2 scale, shift; uniform float size, deep;
    varying float step_, soil;
    void main() {
      vec3 at = turn * (low + span * place * (65535. / 65534.) - centre);
      gl_Position = place.x > 0.99999 && place.y > 0.99999 ? vec4(2, 2, 2, 1) : vec4(at.xy * scale + shift, -at.z / deep, 1);
      gl_PointSize = size; step_ = value; soil = body;
    }`;
  const SPHERES = `
    precision mediump float;
    varying float step_, soil; uniform sampler2D colours, tints; uniform float round_;
    void main() {
      vec2 from = 2. * gl_PointCoord - 1.;
      float far = dot(from, from);
      if (round_ > 0.5 && far > 1.) discard;
      vec3 colour = step_ < 0.5 / 255. ? texture2D(tints, vec2((255. * soil + 0.5) / 64., 0.5)).rgb : texture2D(colours, vec2((255. * step_ - 0.5) / 255., 0.5)).rgb;
      float light = round_ > 0.5 ? 0.62 + 0.38 * max(0., dot(vec3(from.x, -from.y, sqrt(max(0., 1. - far))), vec3(-0.45, 0.6, 0.66))) : 1.;
      gl_FragColor = vec4(colour * light, 1);
    }`;
  const FACES = `
    attribute vec3 place; attribute vec3 normal; uniform mat3 turn; uniform vec3 centre; uniform vec2 scale, shift; uniform float deep; varying float light;
    void main() {
      vec3 at = turn * (place - centre), out_ = turn * normal;
      gl_Position = vec4(at.xy * scale + shift, -at.z / deep, 1); light = 0.55 + 0.45 * abs(dot(normalize(out_), vec3(-0.45, 0.6, 0.66)));
    }`;
  const EARTH = "precision mediump float; varying float light; void main() { gl_FragColor = vec4(vec3(0.72, 0.70, 0.66) * light, 1); }";

  function program(gl, ...sources) {
    const made = gl.createProgram();
    sources.forEach((source, k) => {
      const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    return made;
  }

  function texture(gl, unit, colours, width) {
    const pixels = new Uint8Array(4 * width).fill(255);
    colours.slice(0, width).forEach((colour, k) => pixels.set(colour, 4 * k));
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (const [what, how] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, unit ? gl.NEAREST : gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, what, how);
  }

  // triangles of the ground: [places, normals]
  function facesOf(ground, up) {
    const heights = array(ground.heights), [rows, columns] = ground.shape, places = [], normals = [];
    const corner = (i, j) => {
      const at = [0, 0, 0];
      ground.level.forEach((axis, k) => (at[axis] = ground.low[k] + (ground.high[k] - ground.low[k]) * (k ? j / (columns - 1) : i / (rows - 1))));
      at[up] = heights[i * columns + j];
      return at;
    };
    for (let i = 0; i + 1 < rows; ++i)
      for (let j = 0; j + 1 < columns; ++j)
        for (const three of [[corner(i, j), corner(i + 1, j), corner(i, j + 1)], [corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)]]) {
          const [a, b, c] = three, u = b.map((x, k) => x - a[k]), v = c.map((x, k) => x - a[k]);
          const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
          for (const one of three) { places.push(...one); normals.push(...normal); }
        }
    return [new Float32Array(places), new Float32Array(normals)];
  }

  function play(slide, box) {
    const canvas = make("canvas"), gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) return;
    const solid = slide.dimension === 3, frames = slide.times.length, n = slide.count;
    const place = array(slide.place), three = new Uint16Array(3 * n);
    const field = make("select"), slider = make("input", { type: "range", min: 0, max: frames - 1, value: frames - 1, step: 1 }), run = make("button", { type: "button", textContent: "▶ Play" });
    const said = make("output"), bar = make("div", { className: "bar" });
    slide.fields.forEach((one, k) => field.append(make("option", { value: k, textContent: one.name })));
    slider.setAttribute("aria-label", "time");
    const hint = (solid ? "drag to turn, " : "drag to move, ") + "wheel to enlarge, double click to reset";
    const few = slide.of > n ? `; ${n.toLocaleString("en")} of ${slide.of.toLocaleString("en")} particles` : "";
    box.prepend(make("div", { className: "play" }, canvas, bar, make("div", { className: "controls" }, run, slider, said, field), make("p", { className: "hint", textContent: hint + few })));
    const points = program(gl, POINTS, SPHERES), buffers = [0, 1, 2, 3, 4].map(() => gl.createBuffer());
    const faces = solid && slide.ground ? facesOf(slide.ground, slide.up) : null, earth = faces && program(gl, FACES, EARTH);
    texture(gl, 1, slide.tints, 64);
    const fill = (number, data) => { gl.bindBuffer(gl.ARRAY_BUFFER, buffers[number]); gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW); };
    fill(2, array(slide.body));
    if (faces) { fill(3, faces[0]); fill(4, faces[1]); }
    const flat = (list) => [list[0], list[1], list[2] ?? 0];
    const low = flat(slide.low), high = flat(slide.high), span = high.map((x, k) => x - low[k]), centre = high.map((x, k) => (x + low[k]) / 2);
    const view = {}, reset = () => Object.assign(view, { around: -0.6, above: 0.5, near: 1, x: 0, y: 0 });
    reset();

    function turn() {
      if (!solid) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
      const [c, s, d, t] = [Math.cos(view.around), Math.sin(view.around), Math.cos(view.above), Math.sin(view.above)];
      const rows = slide.up === 2 ? [[c, s, 0], [-s * t, c * t, d], [s * d, -c * d, t]] : [[c, 0, -s], [-s * t, d, -c * t], [s * d, t, c * d]];
      return [0, 1, 2].flatMap((k) => rows.map((row) => row[k]));  // by columns
    }

    function draw() {
      const wide = Math.max(1, canvas.clientWidth), ratio = devicePixelRatio || 1;
      const tall = solid ? 0.62 * wide : Math.min(0.75 * wide, Math.max(0.22 * wide, (1.08 * wide * span[1]) / span[0]));
      canvas.style.aspectRatio = `${wide} / ${tall}`;
      canvas.width = wide * ratio;
      canvas.height = tall * ratio;
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.depthFunc(gl.LEQUAL);
      const across = solid ? Math.hypot(...span) : span[0] + 2 * slide.size, high_ = solid ? across * 0.62 : span[1] + 2 * slide.size;
      const metre = (0.96 * view.near * Math.min(canvas.width / across, canvas.height / high_));  // in pixels
      const uniforms = (of) => {
        gl.useProgram(of);
        const at = (name) => gl.getUniformLocation(of, name);
        gl.uniformMatrix3fv(at("turn"), false, turn());
        gl.uniform3fv(at("centre"), centre);
        gl.uniform2f(at("scale"), (2 * metre) / canvas.width, (2 * metre) / canvas.height);
        gl.uniform2f(at("shift"), view.x, view.y);
        gl.uniform1f(at("deep"), 2 * Math.hypot(...span) + 1);
        return at;
      };
      const attribute = (of, name, buffer, size, kind, normalised) => {
        const at = gl.getAttribLocation(of, name);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[buffer]);
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, size, kind, normalised, 0, 0);
      };
      if (faces) {
        uniforms(earth);
        attribute(earth, "place", 3, 3, gl.FLOAT, false);
        attribute(earth, "normal", 4, 3, gl.FLOAT, false);
        gl.drawArrays(gl.TRIANGLES, 0, faces[0].length / 3);
      }
      const at = uniforms(points);
      gl.uniform3fv(at("low"), low);
      gl.uniform3fv(at("span"), span);
      gl.uniform1f(at("size"), Math.max(1.5, (solid ? 1.5 : 1.6) * slide.size * metre));
      gl.uniform1f(at("round_"), solid ? 1 : 0);
      gl.uniform1i(at("colours"), 0);
      gl.uniform1i(at("tints"), 1);
      attribute(points, "place", 0, 3, gl.UNSIGNED_SHORT, true);
      attribute(points, "value", 1, 1, gl.UNSIGNED_BYTE, true);
      attribute(points, "body", 2, 1, gl.UNSIGNED_BYTE, true);
      gl.drawArrays(gl.POINTS, 0, n);
    }

    function show() {
      const k = Number(slider.value), start = k * n * slide.dimension;
      if (solid) three.set(place.subarray(start, start + 3 * n));
      else for (let i = 0; i < n; ++i) { three[3 * i] = place[start + 2 * i]; three[3 * i + 1] = place[start + 2 * i + 1]; }
      fill(0, three);
      fill(1, array(slide.fields[field.value].value).subarray(k * n, (k + 1) * n));
      said.textContent = slide.says[k];
      draw();
    }

    function choose() {
      const one = slide.fields[field.value];
      texture(gl, 0, one.colours, 64);
      const colours = one.colours.map((colour) => `rgb(${colour})`).join(",");
      bar.replaceChildren(make("b", { textContent: `${one.name}${one.unit ? ` [${one.unit}]` : ""}` }), make("i", { style: `background:linear-gradient(90deg,${colours})` }),
        make("span", {}, ...one.marks.map((mark) => make("small", { textContent: mark }))));
      show();
    }

    let timer = 0;
    const stop = () => { clearInterval(timer); timer = 0; run.textContent = "▶ Play"; };
    run.onclick = () => {
      if (timer) return stop();
      if (Number(slider.value) === frames - 1) slider.value = 0;
      run.textContent = "■ Stop";
      timer = setInterval(() => {
        slider.value = Number(slider.value) + 1;
        show();
        if (Number(slider.value) === frames - 1) stop();
      }, Math.max(60, 4000 / frames));
    };
    slider.oninput = () => { stop(); show(); };
    field.onchange = choose;
    canvas.onpointerdown = (down) => canvas.setPointerCapture(down.pointerId);
    canvas.onpointermove = (move) => {
      if (!move.buttons) return;
      if (solid) { view.around -= move.movementX / 200; view.above = Math.min(1.57, Math.max(-0.3, view.above + move.movementY / 200)); }
      else { view.x += (2 * move.movementX) / canvas.clientWidth; view.y -= (2 * move.movementY) / canvas.clientHeight; }
      draw();
    };
    canvas.onwheel = (wheel) => { wheel.preventDefault(); view.near *= Math.exp(-wheel.deltaY / 600); draw(); };
    canvas.ondblclick = () => { reset(); draw(); };
    addEventListener("resize", draw);
    choose();
    box.classList.add("plays");
  }

  // ---- histories ----

  const PALETTE = ["#0b7285", "#d9480f", "#5f3dc4", "#2b8a3e", "#c2255c", "#e67700", "#6f4518", "#868e96"];

  function ticks(low, high) {
    const step = 10 ** Math.floor(Math.log10((high - low) / 4)), wide = [1, 2, 5, 10].map((k) => k * step).find((one) => (high - low) / one <= 6);
    const found = [];
    for (let at = Math.ceil(low / wide) * wide; at <= high + 1e-9 * wide; at += wide) found.push(Math.abs(at) < 1e-9 * wide ? 0 : at);
    return found;
  }

  function chart(time, one) {
    const canvas = make("canvas"), pen = canvas.getContext("2d"), said = make("output", { textContent: " " });
    const lines = one.lines.map((line) => ({ name: line.name, values: array(line.values) }));
    let [low, high] = [Infinity, -Infinity];
    for (const line of lines) for (const value of line.values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    if (low > 0 && low < 0.5 * high) low = 0;
    if (low === high) high = low + 1;
    const last = time[time.length - 1], first = time[0];
    const names = make("p", {}, ...lines.map((line, k) => make("span", { textContent: `— ${line.name}`, style: `color:${PALETTE[k % 8]}` })));
    function draw(at = -1) {
      const wide = canvas.clientWidth, tall = 240, ratio = devicePixelRatio || 1, [left, right, top, foot] = [58, 12, 10, 34];
      canvas.width = wide * ratio;
      canvas.height = tall * ratio;
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, wide, tall);
      const x = (t) => left + ((t - first) / (last - first)) * (wide - left - right), y = (v) => tall - foot - ((v - low) / (high - low)) * (tall - top - foot);
      pen.font = "11px system-ui, sans-serif";
      pen.fillStyle = "#616e7c";
      pen.strokeStyle = "#e4e7eb";
      pen.textAlign = "right";
      for (const tick of ticks(low, high)) { pen.beginPath(); pen.moveTo(left, y(tick)); pen.lineTo(wide - right, y(tick)); pen.stroke(); pen.fillText(short(tick), left - 6, y(tick) + 4); }
      pen.textAlign = "center";
      for (const tick of ticks(first, last)) pen.fillText(short(tick), x(tick), tall - foot + 16);
      pen.fillText("time [s]", (left + wide) / 2, tall - 4);
      lines.forEach((line, k) => {
        pen.strokeStyle = PALETTE[k % 8];
        pen.lineWidth = 1.5;
        pen.beginPath();
        let on = false;
        line.values.forEach((value, i) => { if (!Number.isFinite(value)) on = false; else { pen[on ? "lineTo" : "moveTo"](x(time[i]), y(value)); on = true; } });
        pen.stroke();
        if (at >= 0 && Number.isFinite(line.values[at])) { pen.fillStyle = PALETTE[k % 8]; pen.beginPath(); pen.arc(x(time[at]), y(line.values[at]), 3.5, 0, 7); pen.fill(); }
      });
      if (at >= 0) { pen.strokeStyle = "#9aa5b1"; pen.lineWidth = 1; pen.beginPath(); pen.moveTo(x(time[at]), top); pen.lineTo(x(time[at]), tall - foot); pen.stroke(); }
      said.textContent = at < 0 ? " " : `t = ${short(time[at])} s:  ` + lines.map((line) => `${line.name} ${short(line.values[at])}`).join(",  ");
    }
    canvas.onpointermove = (move) => {
      const share = (move.offsetX - 58) / (canvas.clientWidth - 70), wanted = first + share * (last - first);
      let [from, to] = [0, time.length - 1];
      while (to - from > 1) { const middle = (from + to) >> 1; if (time[middle] < wanted) from = middle; else to = middle; }
      draw(wanted - time[from] < time[to] - wanted ? from : to);
    };
    canvas.onpointerleave = () => draw();
    addEventListener("resize", () => draw());
    return [make("figure", { className: "chart" }, make("h3", { textContent: one.name + (one.unit ? ` [${one.unit}]` : "") }), canvas, said, names), draw];
  }

  if (about.slide && byId("slide")) play(about.slide, byId("slide"));
  if (about.histories && byId("curves")) {
    const made = about.histories.charts.map((one) => chart(array(about.histories.time), one));
    const named = new Set(about.histories.charts.map((one) => one.name));
    byId("curves").querySelectorAll("figure").forEach((figure) => (figure.hidden = named.has(figure.firstChild.alt)));
    (byId("curves").querySelector("h2") ?? byId("curves")).after(make("div", { className: "grid", style: "margin-bottom:14px" }, ...made.map(([figure]) => figure)));
    made.forEach(([, draw]) => draw());
  }
  document.documentElement.dataset.ready = "yes";
})();
