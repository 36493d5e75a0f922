/* Draws each chart when it comes near the screen, in place of its still picture; tells the values of the row under the
   pointer or chosen by the keyboard; zooms. The specifications come from charts.py, the data stand in the page as CSV. */
'use strict';
(() => {
  const { config, charts } = JSON.parse(document.getElementById('charts').textContent);
  const tables = new Map();
  const NEAR = 40; // px: farther from any point, nothing is meant

  const rowsOf = (id) => {
    if (!tables.has(id)) {
      const [head, ...lines] = document.getElementById(`rows.${id}`).textContent.split('\n');
      const names = head.split(',');
      const value = (cell) => (cell === '' ? null : Number.isNaN(Number(cell)) ? cell : Number(cell));
      tables.set(id, lines.map((line) => Object.fromEntries(line.split(',').map((cell, i) => [names[i], value(cell)]))));
    }
    return tables.get(id);
  };

  const RAISED = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };
  const show = (value) => {
    if (value === null) return '–';
    if (typeof value !== 'number') return String(value);
    const size = Math.abs(value);
    if (size && (size < 1e-3 || size >= 1e5)) {
      const [mantissa, power] = value.toExponential().split('e');
      const raised = [...power.replace('+', '')].map((sign) => RAISED[sign]).join('');
      return `${Number(mantissa)}·10${raised}`.replace('-', '−');
    }
    return String(value).replace('-', '−');
  };

  class Plot {
    constructor(element) {
      this.element = element;
      this.spec = charts[element.id];
      this.about = this.spec.usermeta;
      this.index = -1;
      this.spoken = document.createElement('p');
      this.spoken.className = 'unseen';
      this.spoken.setAttribute('role', 'status');
      element.after(this.spoken);
      element.tabIndex = 0;
      element.setAttribute('role', 'application');
      element.setAttribute('aria-roledescription', 'chart');
      element.addEventListener('keydown', (event) => this.key(event));
      element.addEventListener('blur', () => this.choose(-1));
    }

    async draw() {
      this.drawing ??= this.embed();
      return this.drawing;
    }

    async embed() {
      this.rows = rowsOf(this.about.table);
      const drawn = document.createElement('div');
      drawn.className = 'drawn';
      drawn.setAttribute('aria-hidden', 'true'); // named and told by the chart around it
      drawn.style.visibility = 'hidden';
      drawn.style.position = 'absolute';
      this.element.append(drawn);
      const spec = { ...this.spec, data: { name: 'rows', values: this.rows.map((row) => ({ ...row })) } };
      const options = { config, renderer: 'svg', actions: false, tooltip: false, ast: true, defaultStyle: false };
      const { view } = await vegaEmbed(drawn, spec, options);
      this.view = view;
      this.element.querySelector(':scope > svg').remove();
      drawn.removeAttribute('style');
      this.tip = document.createElement('div');
      this.tip.className = 'tip';
      this.tip.hidden = true;
      this.tip.setAttribute('aria-hidden', 'true');
      this.element.append(this.tip);
      for (const kind of ['pointermove', 'pointerdown']) {
        this.element.addEventListener(kind, (event) => this.choose(this.under(event)));
      }
      this.element.addEventListener('pointerleave', () => this.choose(-1));
      this.element.classList.add('ready');
    }

    /* Where a row stands, in px from the upper left corner of the picture. */
    place(row) {
      const [left, top] = this.view.origin();
      const x = this.view.scale('x')(row[this.about.x]);
      const y = this.about.nearest === 'xy' ? this.view.scale('y')(row[this.about.y]) : 0;
      return [left + x, top + y];
    }

    /* The row that is meant by a place of the pointer, or -1. */
    under(event) {
      const box = this.element.querySelector('svg').getBoundingClientRect();
      const [px, py] = [event.clientX - box.left, event.clientY - box.top];
      const [left, top] = this.view.origin();
      const [width, height] = [this.view.signal('width') ?? this.view.width(), this.view.height()];
      if (px < left || px > left + width || py < top || py > top + height) return -1;
      let [best, found] = [Infinity, -1];
      this.rows.forEach((row, i) => {
        const [x, y] = this.place(row);
        const away = this.about.nearest === 'x' ? Math.abs(x - px) : Math.hypot(x - px, y - py);
        if (away < best) [best, found] = [away, i];
      });
      return this.about.nearest === 'xy' && best > NEAR ? -1 : found;
    }

    choose(i) {
      if (!this.view || i === this.index) return;
      this.index = i;
      this.view.signal('cursor', i).runAsync();
      this.tip.hidden = i < 0;
      if (i < 0) { this.spoken.textContent = ''; return; }
      const row = this.rows[i];
      const said = this.about.says.filter(([column]) => row[column] !== null && row[column] !== undefined)
        .map(([column, name, unit]) => [name, `${show(row[column])}${unit ? ` ${unit}` : ''}`]);
      this.tip.replaceChildren(...said.map(([name, value]) => {
        const line = document.createElement('div');
        const label = document.createElement('span');
        label.innerHTML = name; // symbols, set by words.py
        line.append(label, value);
        return line;
      }));
      const [x, y] = this.place(row);
      const room = this.element.clientWidth - this.tip.offsetWidth;
      const beside = x + 14 <= room ? x + 14 : x - 14 - this.tip.offsetWidth;
      this.tip.style.left = `${Math.max(0, Math.min(room, beside))}px`;
      this.tip.style.top = `${Math.max(0, y + 14)}px`;
      this.spoken.innerHTML = said.map((pair) => pair.join(': ')).join(', ');
    }

    /* Show a stretch of both axes: `share` of what is seen now, moved by shares of it; null for everything. */
    zoom(share, right = 0, up = 0) {
      if (!this.view) return;
      for (const [name, move] of [['x', right], ['y', up]]) {
        const scale = this.view.scale(name);
        const maps = { log: [Math.log, Math.exp] };
        if (scale.type === 'symlog') {
          const c = scale.constant();
          maps.symlog = [(v) => Math.sign(v) * Math.log1p(Math.abs(v / c)), (v) => Math.sign(v) * Math.expm1(Math.abs(v)) * c];
        }
        const [to, from] = maps[scale.type] ?? [(v) => v, (v) => v];
        const [low, high] = scale.domain().map(to);
        const [middle, half] = [(low + high) / 2 + move * (high - low), (share * (high - low)) / 2];
        // Vega-Lite names the signals of a zoom by the fields of the layer that has it, which is the first.
        const { field } = this.spec.layer[0].encoding?.[name] ?? this.spec.encoding[name];
        this.view.signal(`grid_${field}`, share === null ? null : [from(middle - half), from(middle + half)]);
      }
      this.view.runAsync();
    }

    key(event) {
      if (!this.view || event.ctrlKey || event.metaKey || event.altKey) return;
      const steps = { ArrowRight: 1, ArrowLeft: -1, PageDown: 20, PageUp: -20 };
      const moves = { ArrowRight: [0.15, 0], ArrowLeft: [-0.15, 0], ArrowUp: [0, 0.15], ArrowDown: [0, -0.15] };
      const last = this.rows.length - 1;
      if (event.shiftKey && event.key in moves) this.zoom(1, ...moves[event.key]);
      else if (event.key in steps) this.choose(Math.max(0, Math.min(last, this.index + steps[event.key])));
      else if (event.key === 'Home') this.choose(0);
      else if (event.key === 'End') this.choose(last);
      else if (event.key === 'Escape') this.choose(-1);
      else if (event.key === '+' || event.key === '=') this.zoom(0.6);
      else if (event.key === '-' || event.key === '−') this.zoom(1 / 0.6);
      else if (event.key === '0') this.zoom(null);
      else return;
      event.preventDefault();
    }
  }

  const plots = new Map([...document.querySelectorAll('.plot')].map((element) => [element, new Plot(element)]));
  const near = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      near.unobserve(entry.target);
      plots.get(entry.target).draw();
    }
  }, { rootMargin: '400px' });
  for (const element of plots.keys()) near.observe(element);

  for (const tools of document.querySelectorAll('.tools')) {
    const own = [...tools.parentElement.querySelectorAll('.plot')].map((element) => plots.get(element));
    tools.hidden = false;
    tools.addEventListener('click', async (event) => {
      const share = { in: 0.6, out: 1 / 0.6, reset: null }[event.target.dataset.zoom];
      if (share === undefined) return;
      await Promise.all(own.map((plot) => plot.draw()));
      for (const plot of own) plot.zoom(share);
    });
  }
})();
