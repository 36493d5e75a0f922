/* What the instruments share: the balance, drawings, controls, a state that stands in the address, and code to copy.
   kit.instrument(id, (it) => { …; return draw; }) builds the element of that id once the engine runs; draw(it.values) follows every
   change. it.engine; it.data of the case; it.values by control, in the units shown: those of the template and, for a state of
   another kind, it.control(name, value, given); a button with the name of a control and a value sets it. it.redraw, it.find,
   it.write(selector, html), it.drawing, it.code. */
const kit = (() => {
  'use strict';
  const power = (_, exponent) => `·10${[...exponent].map((sign) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)]).join('')}`;
  const raised = (text) => text.replace(/e\+?(-?\d+)/i, power).replace(/^-/, '−'); // as project/wording.py writes numbers
  const number = (value, digits = 4) => {
    if (!value || !Number.isFinite(value)) return value === 0 ? '0' : '–';
    return raised(Math.abs(value) < 10 ** digits ? value.toPrecision(digits) : value.toFixed(0)).replace('-', '−');
  };
  const percent = (share, plus = '+') => {
    const size = 100 * Math.abs(share);
    return Number.isFinite(size) ? `${share < 0 ? '−' : plus}${raised(size < 1e-3 || size >= 1e4 ? size.toExponential(1) : number(size, 3))}\u00a0%` : '–';
  };
  const rich = (text) => text.replace(/([A-Za-zφω])_(\w)/g, '<i>$1</i><sub>$2</sub>');

  // The balance a F_k + b c = W. A response is what the engine gives, with the parameters.
  const response = (engine, parameters) => ({ ...parameters, ...engine.steady(parameters) });
  const travel = {
    X_s: (r) => 2 * (r.X - r.X_s),
    t_s: (r) => 2 * r.X * (1 + Math.cos(r.omega * r.t_s)),
    V_s: (r) => 2 * r.X * (1 + Math.sqrt(1 - (r.V_s / (r.omega * r.X)) ** 2)),
  };
  const PHASES = { reversal: 'phi', zero_crossing: 'phi_zero_crossing', fundamental: 'phi_fundamental' };
  const sum = (values) => values.reduce((total, v) => total + v, 0);
  const finite = (values) => values.filter(Number.isFinite);
  const mean = (values) => sum(finite(values)) / finite(values).length;

  /* Rows {a, b, W} of responses by an approach, a key of balance.APPROACHES. The harmonic ones take a phase, a key of PHASES:
     that of each response or, shared, its mean over those that have it, and likewise t_s. */
  function rows(approach, responses, phase = 'reversal', shared = false) {
    if (approach === 'direct') return responses.map(({ a, b, W }) => ({ a, b, W }));
    const [phi, t_s] = [PHASES[phase], 't_s'].map((name) => {
      const each = responses.map((r) => r[name]);
      return shared ? each.map((v) => (Number.isFinite(v) ? mean(each) : v)) : each;
    });
    return responses.map((r, i) => (approach === 'fourier' ? {
      a: travel.X_s(r),
      b: Math.PI * r.omega * (r.X_1 ** 2 + 9 * r.X_3 ** 2 + 25 * r.X_5 ** 2),
      W: Math.PI * r.k * r.Y * r.X_1 * Math.sin(r.phi_fundamental),
    } : { a: travel[approach]({ ...r, t_s: t_s[i] }), b: Math.PI * r.omega * r.X ** 2, W: Math.PI * r.k * r.Y * r.X * Math.sin(phi[i]) }));
  }

  /* {F_k, c, n} by least squares of the finite rows; NaN where they do not tell. */
  function solve(all) {
    let [n, aa, ab, bb, aW, qq, qW] = [0, 0, 0, 0, 0, 0, 0];
    const each = (add) => all.forEach((r) => { if (Number.isFinite(r.a + r.b + r.W)) add(r); });
    each(({ a, b, W }) => { n += 1; aa += a * a; ab += a * b; bb += b * b; aW += a * W; });
    each(({ a, b, W }) => { const q = b - (ab / aa) * a; qq += q * q; qW += q * W; }); // b without its share along a
    const c = n > 1 && qq > 1e-24 * bb ? qW / qq : NaN;
    return { F_k: (aW - c * ab) / aa, c, n };
  }

  // Drawings: SVG in CSS pixels, so that text has one size on every screen.
  function element(parent, tag, attributes = {}, text = null) {
    const one = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const attribute of Object.entries(attributes)) one.setAttribute(...attribute);
    if (text !== null) one.innerHTML = String(text).replace(/_(\w)/g, '<tspan dy="3" font-size="75%">$1</tspan><tspan dy="-3">&#8203;</tspan>');
    return parent.appendChild(one);
  }
  function ticks([low, high], count) {
    const power = 10 ** Math.floor(Math.log10((high - low) / count));
    const step = power * [1, 2, 5, 10].find((m) => m * power * count >= 0.999 * (high - low));
    const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
    const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => [(first + i) * step, ((first + i || 0) * step).toFixed(places).replace('-', '−')]);
  }
  const SHAPES = { // as in the legends of the page
    circle: 'M-4.5 0A4.5 4.5 0 1 1 4.5 0A4.5 4.5 0 1 1 -4.5 0Z', square: 'M-4.5-4.5h9v9h-9Z', diamond: 'M0-6L6 0L0 6L-6 0Z',
    'triangle-up': 'M0-5.5L5.5 5H-5.5Z', cross: 'M-2-5h4v3h3v4h-3v3h-4v-3h-3v-4h3Z',
  };

  // An entry of a legend.
  const key = ({ shape, colour }, words) => `<li><svg class="key" viewBox="-8 -8 16 16" aria-hidden="true"><path d="${SHAPES[shape]}" fill="${colour}"/></svg><span>${words}</span></li>`;

  /* Axes over a whole svg of it.drawing, with dotted lines at the truth [x, y]. Returns the scales X, Y and line, area, dot, text,
     which take values and classes of CSS. */
  function plot(svg, { x, y, labels = ['', ''], truth = [] }) {
    const [width, height] = svg.size ?? [320, 240];
    const [left, top, right, bottom] = [44, 24, width - 12, height - 38];
    const X = (v) => left + ((v - x[0]) / (x[1] - x[0])) * (right - left);
    const Y = (v) => bottom - ((v - y[0]) / (y[1] - y[0])) * (bottom - top);
    const grid = (value, d) => element(svg, 'path', { d, class: value === 0 ? 'zero' : 'grid' });
    const write = (u, v, anchor, words, css = '') => element(svg, 'text', { x: u, y: v, 'text-anchor': anchor, class: css }, words);
    svg.replaceChildren();
    svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    for (const [v, words] of ticks(x, Math.max(4, width / 80))) { grid(v, `M${X(v)} ${top}V${bottom}`); write(X(v), bottom + 15, 'middle', words); }
    for (const [v, words] of ticks(y, Math.max(3, height / 45))) { grid(v, `M${left} ${Y(v)}H${right}`); write(left - 6, Y(v) + 4, 'end', words); }
    write(right, height - 5, 'end', labels[0], 'label');
    write(2, 13, 'start', labels[1], 'label');
    const [w, h] = [right - left, bottom - top]; // of the plane inside, which clips
    const inside = element(svg, 'svg', { x: left, y: top, width: w, height: h, viewBox: `${left} ${top} ${w} ${h}` });
    const path = (points) => points.map(([u, v], i) => `${i ? 'L' : 'M'}${X(u).toFixed(2)} ${Y(v).toFixed(2)}`).join('');
    const line = (points, css = '') => element(inside, 'path', { d: path(points), class: `line ${css}` });
    if (truth.length) for (const ends of [y.map((v) => [truth[0], v]), x.map((u) => [u, truth[1]])]) line(ends, 'truth');
    return {
      X, Y, path, line,
      area: (points, css = '') => element(inside, 'path', { d: path(points), class: `area ${css}` }),
      dot: (u, v, css = '', shape = 'circle', style = '') => Number.isFinite(u + v) && element(inside, 'path', {
        d: SHAPES[shape], transform: `translate(${X(u)} ${Y(v)})`, class: `dot ${css}`, style }),
      text: (u, v, words, attributes = {}) => element(inside, 'text', { x: X(u), y: Y(v), ...attributes }, words),
    };
  }

  // The text of a <template> with its ‹names› filled in; in YAML 5e-6 is a word, 5.0e-6 a number.
  const decimal = (v) => String(v).replace(/^(-?\d+)e/, '$1.0e');
  const filled = (template, values) => template.content.textContent.trimStart().replace(/‹(\w+)›/g, (_, name) => [values[name]].flat().map(decimal).join(', '));

  let started = null;
  const text = (id) => document.getElementById(id).textContent;
  async function start() {
    const bytes = Uint8Array.from(atob(text('engine').trim()), (sign) => sign.charCodeAt(0));
    return { engine: await loadEngine(bytes), data: JSON.parse(text('instruments-data')) };
  }

  async function instrument(id, build) {
    const root = globalThis.document?.getElementById(id);
    if (!root) return;
    const it = { root, values: {}, find: (selector) => root.querySelector(selector) };
    const [defaults, controls] = [{}, {}];
    let [draw, frame, timer] = [null, 0, 0];
    it.redraw = () => { frame ||= requestAnimationFrame(() => { frame = 0; draw(it.values); it.tell?.(); }); };
    const show = (name, v) => {
      it.values[name] = v;
      controls[name].shown(v);
      for (const one of root.querySelectorAll(`button[name=${name}]`)) one.setAttribute('aria-pressed', one.value === String(v));
      it.redraw();
    };
    const save = () => {
      const changed = Object.entries(it.values).filter(([name, v]) => v !== defaults[name]);
      history.replaceState(null, '', `#${id}${changed.length ? `?${new URLSearchParams(changed)}` : ''}`);
    };
    const restore = () => {
      const [place, query] = location.hash.slice(1).split('?');
      const given = new URLSearchParams(query);
      if (place !== id || query === undefined) return; // a plain #id is an anchor like any other
      for (const [name, v] of Object.entries(defaults)) show(name, given.has(name) ? controls[name].accept(given.get(name)) : v);
    };
    const change = ({ type: kind, target: { name, value, type } }) => { // moved, chosen or pressed
      if (!controls[name] || (kind === 'click') !== (type === 'button')) return;
      show(name, (type === 'range' ? controls[name].from : controls[name].accept)(value));
      clearTimeout(timer);
      timer = setTimeout(save, 250);
    };
    it.control = (name, value, given, shown = () => {}, from = null) => { // given : what it makes of a text, or the texts that it takes
      const accept = Array.isArray(given) ? (text) => (given.includes(text) ? text : value) : given;
      [defaults[name], controls[name]] = [value, { shown, accept, from }];
      show(name, value);
    };
    it.write = (selector, markup) => { it.find(selector).innerHTML = markup; };
    const slide = (input) => { // as `slider` in instrument_macros.html.j2 says: with `log` it moves in decades
      const { value, min, max, step = 1, unit = '', log = false } = JSON.parse(input.dataset.of);
      const [to, from] = log ? [Math.log10, (v) => Number((10 ** v).toPrecision(3))] : [Number, Number];
      Object.assign(input, { min: to(min), max: to(max), step: log ? 0.01 : step });
      const shown = (v) => {
        input.value = to(v);
        input.setAttribute('aria-valuetext', `${v} ${unit}`);
        input.previousElementSibling.textContent = `${v}\u00a0${unit}`;
      };
      it.control(input.name, value, (given) => (given && Number.isFinite(Number(given)) ? Math.min(max, Math.max(min, Number(given))) : value), shown, from);
    };
    it.drawing = (selector, height) => {
      const svg = it.find(selector);
      svg.style.height = `${height}px`;
      new ResizeObserver(([{ contentRect: { width } }]) => {
        if (width && width !== svg.size?.[0]) { svg.size = [width, height]; it.redraw(); }
      }).observe(svg);
      return svg;
    };
    it.code = (values) => { // the texts below the instrument; values() → what their ‹names› stand for
      const fold = it.find('.code');
      it.tell = () => {
        if (fold.open) for (const one of fold.querySelectorAll('template')) one.previousElementSibling.textContent = filled(one, { ...it.data.case, ...it.values, ...values() });
      };
      fold.addEventListener('toggle', it.tell);
      fold.addEventListener('click', ({ target }) => {
        if (target.type !== 'button') return;
        const text = target.closest('div').querySelector('pre');
        getSelection().selectAllChildren(text);
        navigator.clipboard?.writeText(text.textContent).catch(() => {}); // selected, if nothing else
      });
    };
    Object.assign(it, await (started ??= start()));
    for (const input of root.querySelectorAll('.controls input')) slide(input);
    for (const one of root.querySelectorAll('.controls select')) it.control(one.name, one.value, [...one.options].map(({ value }) => value), (v) => { one.value = v; });
    for (const kind of ['input', 'click']) root.addEventListener(kind, change);
    draw = build(it);
    addEventListener('hashchange', restore);
    restore();
    root.classList.add('ready');
    // The instruments above have their full height from now on, and what the address names has moved down with it.
    requestAnimationFrame(() => requestAnimationFrame(() => { if (location.hash.slice(1).split('?')[0] === id) root.scrollIntoView(); }));
  }

  return { instrument, number, percent, raised, rich, response, rows, solve, element, plot, key, PHASES, finite, mean };
})();
if (typeof module !== 'undefined') module.exports = kit;
