/* Guess the integrator: which scheme, step and coefficients give the 25 numbers of Table 2. */
const integrator = (() => {
  'use strict';
  /* A printed number against another value: how many units of the last digit the value is off, how many of the digits of the text
     then still agree, and in words how close that is: "all" digits, "near" (less than ten units), "off" or "none". */
  function compared(text, value) {
    const unit = 10 ** -(text.split('.')[1] ?? '').length;
    const units = (value - Number(text)) / unit;
    const wrong = Math.max(0, Math.ceil(Math.log10(Math.abs(2 * units)) - 1e-9));
    const digits = text.replace(/^[0.]+|\./g, '').length;
    const close = !Number.isFinite(units) ? 'none' : Math.abs(units) <= 0.5 ? 'all' : Math.abs(units) < 10 ? 'near' : 'off';
    return { units, close, wrong: close === 'none' ? digits : Math.min(wrong, digits) };
  }

  /* What Table 2 would hold: a, b, W of the levels that there are, and F_k, c of the pairs of levels that there are. */
  const table = (levels, pairs, solve) => ({
    ...Object.fromEntries(['a', 'b', 'W'].map((name) => [name, levels.map((level) => level[name])])),
    ...Object.fromEntries(['F_k', 'c'].map((name) => [name, pairs.map((pair) => solve(pair.map((i) => levels[i]).filter(Boolean))[name])])),
  });

  function build(it) {
    const { number, rich } = kit;
    const { case: set, integrator: { schemes, recipe, rounded, printed, pairs, omega } } = it.data;
    const COLUMNS = Object.keys(printed);
    const LOOK = Object.fromEntries([['a', 'circle', 'X-s'], ['b', 'square', 't-s'], ['W', 'triangle-up', 'V-s'], ['F_k', 'diamond', 'other'], ['c', 'cross', 'fourier']]
      .map(([name, shape, colour]) => [name, { shape, colour: `var(--${colour})` }]));
    const MARKS = { all: ['✓', 'every digit'], near: ['≈', 'near'], off: ['', ''], none: ['', ''] };
    const svg = it.drawing('.distances', 250);
    const known = new Map(); // simulations that were done
    let [wanted, turn] = ['', Promise.resolve()];

    function draw(values) {
      const key = wanted = JSON.stringify(values);
      const given = { ...set, ...values, omega, step: values.step * 1e-6, ...(values.coefficients === 'rounded' ? rounded : {}) };
      const levels = known.get(key) ?? known.set(key, []).get(key);
      if (levels.length) show(values, levels); else it.root.classList.add('busy');
      turn = turn.then(async () => { // one level after the other, as long as nothing else is wanted
        while (key === wanted && levels.length < set.levels.length) {
          const [Y, slip_samples] = [set.levels, recipe.slip_samples].map((all) => all[levels.length]);
          levels.push(await it.march({ ...given, Y, slip_samples }));
          it.redraw();
        }
      });
    }

    function show({ scheme, step, coefficients }, levels) {
      const done = levels.length === set.levels.length;
      it.root.classList.toggle('busy', !done);
      const values = table(levels, pairs, kit.solve);
      const all = COLUMNS.flatMap((name) => printed[name].map((text, i) => ({ name, i, text, ...compared(text, values[name][i]) })));
      const cell = ({ text, wrong, units, close }) => {
        const [mark, words] = MARKS[close];
        const cut = text.length - wrong - (text.slice(-wrong - 1).includes('.') && wrong ? 1 : 0);
        const off = Number.isFinite(units) ? `${units < 0 ? '−' : '+'}${Math.abs(units) < 100 ? Math.abs(units).toFixed(1) : number(Math.abs(units), 2)}` : '–';
        return `<td class="num ${close}"><span class="digits"><b>${text.slice(0, cut)}</b>${text.slice(cut)}</span> <span class="mark" aria-hidden="true">${mark}</span><span class="unseen">${words}</span> <small>${off}</small></td>`;
      };
      const rows = (names, heads) => heads.map((head, i) => `<tr><th scope="row">${head}</th>${names.map((name) => cell(all.find((one) => one.name === name && one.i === i))).join('')}</tr>`).join('');
      it.write('.upper tbody', rows(['a', 'b', 'W'], set.levels.map((Y) => `${Number((1e3 * Y).toPrecision(12))} mm`)));
      it.write('.lower tbody', rows(['F_k', 'c'], pairs.map((pair) => pair.map((i) => i + 1).join('–'))));
      const count = (...close) => all.filter((one) => close.includes(one.close)).length;
      const { label, dissipation } = schemes.find(({ name }) => name === scheme);
      const put = coefficients === 'rounded' ? rounded.c_over_m * set.m : set.c; // the c that is simulated
      const acts = put + dissipation * set.m * omega ** 2 * step * 1e-6;
      const { c } = kit.solve(levels);
      const why = dissipation
        ? `To first order ${label} acts as <i>c</i> ${dissipation > 0 ? '+' : '−'} <i>m</i>ω²<i>h</i> = ${number(acts, 6)} N s/m: it ${dissipation > 0 ? 'damps' : 'feeds'} the motion, as another <i>c</i> would. `
        : `Near resonance this scheme adds no damping to <i>c</i> = ${number(put, 6)} N s/m, at this step or any other. `;
      it.write('.words', `<b>${count('all', 'near')} of ${all.length}</b> numbers come within ten units of their last digit, ${count('all')} of them in every digit${done ? '' : ` (${levels.length} of ${set.levels.length} levels so far)`}. ${why}The simulated levels together give <i>c</i> = ${number(c, 6)}; the pairs that the paper prints give ${printed.c.reduce((x, y) => (x < y ? x : y))} to ${printed.c.reduce((x, y) => (x > y ? x : y))}.`);
      const plane = kit.plot(svg, { x: [0.4, set.levels.length + 0.6], y: [-2.2, 6], labels: ['row of the table', 'log₁₀ of the distance from print, in units of the last digit'] });
      plane.area([[0, -3], [9, -3], [9, 1], [0, 1]], 'within');
      plane.line([[0, Math.log10(0.5)], [9, Math.log10(0.5)]], 'truth');
      for (const { name, i, units } of all) {
        const height = Math.min(5.9, Math.max(-2.1, Math.log10(Math.abs(units))));
        const aside = 0.12 * (COLUMNS.indexOf(name) - 2);
        plane.dot(i + 1 + aside, height, '', LOOK[name].shape, `fill:${LOOK[name].colour}`);
      }
    }
    it.write('.legend', COLUMNS.map((name) => kit.key(LOOK[name], name.length > 1 ? rich(name) : `<i>${name}</i>`)).join(''));

    it.code(() => {
      const { scheme, step, coefficients } = it.values;
      const [c, k] = coefficients === 'rounded' ? recipe.decimals : ['null', 'null']; // as YAML has it
      return { step: step.toFixed(1), name: scheme.replace(/\W/g, '_'), c, k };
    });
    return draw;
  }

  kit.instrument('integrator', build);
  return { compared, table };
})();
if (typeof module !== 'undefined') module.exports = integrator;
