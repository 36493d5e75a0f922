/* Why it fails: the phases of the levels, the lines of the balance in the F_k–c plane, where they meet, and what mends it. */
kit.instrument('off_resonance', (it) => {
  'use strict';
  const { number, percent, rich, rows, solve, finite, mean } = kit;
  const { case: set, approaches, steps } = it.data;
  const truth = (estimate, name) => estimate[name] / (set[name] || NaN) - 1;
  const millimetres = ({ Y }) => Number((1e3 * Y).toPrecision(12));
  // The phases have colours and shapes of approaches, which no picture shows beside them.
  const { X_s, V_s, t_s } = approaches;
  const phases = { reversal: ['velocity reversal', X_s], zero_crossing: ['zero crossing', V_s], fundamental: ['fundamental', t_s] };
  it.control('step', steps[0].name, steps.map(({ name }) => name));
  it.write('.of-phases', Object.values(phases).map(([words, look]) => kit.key(look, words)).join(''));
  const drawings = { plane: it.drawing('.plane', 400), phases: it.drawing('.phases', 240), sine: it.drawing('.sine', 240) };
  let [solved, responses] = [null, []];

  function draw({ f, approach, step }) {
    if (solved !== f) {
      responses = set.levels.map((Y) => kit.response(it.engine, { ...set, Y, omega: 2 * Math.PI * f }));
      solved = f;
    }
    const by = (name, { phase, sharing }) => rows(name, responses, phase || 'reversal', sharing === 'common');
    const ways = steps.map((way) => {
      const lines = by(way.phase ? approach : way.approach, way);
      const pairs = set.pairs.map((pair) => solve(pair.map((i) => lines[i])));
      const worst = Math.max(...finite(pairs.map((pair) => Math.abs(truth(pair, 'F_k')))));
      return { way, lines, pairs, worst, fit: solve(lines) };
    });
    ways.forEach(({ fit, worst }, i) => {
      const errors = [percent(truth(fit, 'F_k')), percent(worst, ''), percent(truth(fit, 'c'))];
      errors.forEach((error, n) => { it.find('.steps').tBodies[0].rows[i].cells[n + 1].textContent = error; });
    });
    const now = ways.find(({ way }) => way.name === step);
    const estimates = Object.keys(approaches).map((name) => [approaches[name], solve(by(name, now.way))]);
    const { way, fit, worst, pairs } = now;
    const found = finite(pairs.map(({ F_k }) => F_k / set.F_k));
    const [apart, off] = [Math.max(...found) - Math.min(...found), Math.abs(mean(found) - 1)];
    const sine = solve(rows('fourier', responses.map((r) => ({ ...r, X_3: 0, X_5: 0 })))); // of the fundamental alone
    it.write('.words', `At ${f}\u00a0Hz, with ${way.words}${way.phase ? `, by ${rich(approaches[approach].label)}` : ''}: <b>${rich('F_k')} = ${number(fit.F_k)}\u00a0N</b>
      (${percent(truth(fit, 'F_k'))}) and <b><i>c</i> = ${number(fit.c)}\u00a0N\u00a0s/m</b> (${percent(truth(fit, 'c'))}) by least squares over
      ${fit.n} levels; the worst pair is off by ${percent(worst, '')} in ${rich('F_k')}. The true values are ${set.F_k}\u00a0N and ${set.c}\u00a0N\u00a0s/m.
      ${apart < 0.5 * off ? `The pairs are within ${percent(apart, '')} of each other, and all of them are wrong.` : ''}
      ${step === 'fundamental' ? `The third cause remains, the harmonics: ${rich('X')} stands for the amplitude of the fundamental. With that amplitude instead,
      ${percent(truth(sine, 'F_k'))} remain, which the harmonics in <i>b</i> account for; the Fourier balance has both.` : ''}`);
    it.write('.solutions', estimates.map(([look, one]) => kit.key(look, `${rich(look.label)} ${percent(truth(one, 'F_k'))}`)).join(''));
    lines(now, estimates);
    angles(way);
  }

  function lines({ lines: all, pairs }, estimates) {
    const shown = [...pairs, ...estimates.map(([, one]) => one)].filter(({ c }) => Number.isFinite(c));
    const around = (name, least) => {
      const most = Math.max(least, ...shown.map((one) => 1.2 * Math.abs(one[name] - set[name])));
      return [set[name] - most, set[name] + most];
    };
    const [x, y] = [around('F_k', set.F_k || 1e-3), around('c', 0.2 * set.c || 1e-3)];
    const plane = kit.plot(drawings.plane, { x, y, labels: ['F_k, N', 'c, N s/m'], truth: [set.F_k, set.c] });
    plane.text(x[1], set.c, 'truth', { dx: -4, dy: -5, 'text-anchor': 'end', class: 'tag' });
    const taken = []; // by labels, in pixels
    const free = ([F, c]) => F > x[0] && c < y[1] && taken.every(([u, v]) => Math.abs(plane.X(F) - u) > 46 || Math.abs(plane.Y(c) - v) > 15);
    all.forEach(({ a, b, W }, i) => {
      if (!Number.isFinite(a + b + W)) return;
      const at = (F) => (W - a * F) / b;
      plane.line(x.map((F) => [F, at(F)]), 'level');
      const end = Math.min(x[1], (W - b * y[0]) / a); // where it leaves the picture
      const spot = Array.from({ length: 17 }, (_, n) => end - (0.08 + 0.05 * n) * (x[1] - x[0])).map((F) => [F, at(F)]).find(free);
      if (!spot) return;
      taken.push([plane.X(spot[0]), plane.Y(spot[1])]);
      plane.text(...spot, `${millimetres(responses[i])} mm`, { dy: 4, 'text-anchor': 'middle', class: 'tag' });
    });
    for (const [look, one] of estimates) plane.dot(one.F_k, one.c, 'fit', look.shape, `fill:${look.colour}`);
    for (const one of pairs) plane.dot(one.F_k, one.c, 'pair');
  }

  function angles({ phase, sharing }) {
    const Ys = responses.map(millimetres);
    const each = Object.keys(phases).map((name) => [name, responses.map((r) => r[kit.PHASES[name]])]);
    const every = finite(each.flatMap(([, phis]) => phis));
    const cell = (value) => `<td class="num">${number(value)}</td>`;
    const heads = Object.values(phases).map(([words]) => `<th scope="col" class="num">φ of the ${words}</th><th scope="col" class="num">sin φ</th>`);
    const level = (Y, i) => `<tr><th scope="row">${Y}</th>${each.map(([, phis]) => cell(phis[i]) + cell(Math.sin(phis[i]))).join('')}</tr>`;
    it.write('.levels', `<thead><tr><th scope="col"><i>Y</i>, mm</th>${heads.join('')}</tr></thead><tbody>${Ys.map(level).join('')}</tbody>`);
    if (!every.length) return;
    const [low, high] = [Math.min(...every), Math.max(...every)];
    const room = (least) => Math.max(0.12 * (high - low), 0.5 * (least - high + low));
    const around = (least) => [low - room(least), high + room(least)];
    const [width, wide] = [0.06 * (Ys.at(-1) - Ys[0]), around(0.6)];
    const upper = kit.plot(drawings.phases, { x: [Ys[0] - width, Ys.at(-1) + width], y: around(0.06), labels: ['level Y, mm', 'φ, rad'] });
    const lower = kit.plot(drawings.sine, { x: wide, y: [Math.min(0, Math.sin(wide[1]), Math.sin(wide[0])), 1.08], labels: ['φ, rad', 'sin φ'] });
    const sines = Array.from({ length: 81 }, (_, i) => wide[0] + (i / 80) * (wide[1] - wide[0]));
    lower.line(sines.map((phi) => [phi, Math.sin(phi)]), 'curve');
    for (const [name, phis] of each) {
      const used = name === (phase || 'fundamental');
      const [{ colour, shape }, css] = [phases[name][1], used ? '' : 'dim'];
      upper.line(Ys.map((Y, i) => [Y, phis[i]]).filter(([, phi]) => Number.isFinite(phi)), `phase ${css}`).style.stroke = colour;
      for (const [i, phi] of phis.entries()) {
        upper.dot(Ys[i], phi, css, shape, `fill:${colour}`);
        lower.dot(phi, Math.sin(phi), css, shape, `fill:${colour}`);
      }
      if (!used || sharing !== 'common') continue;
      upper.line([[Ys[0], mean(phis)], [Ys.at(-1), mean(phis)]], 'mean');
      lower.line([[mean(phis), -1], [mean(phis), Math.sin(mean(phis))]], 'mean');
    }
  }

  it.code(() => {
    const { approach, step } = it.values;
    const { phase, sharing, approach: own } = steps.find(({ name }) => name === step);
    const chosen = `${phase ? `.with_phase("${phase}")` : ''}${sharing === 'common' ? '.with_common("phi", "t_s")' : ''}`;
    return {
      approach: phase ? approach : own,
      chosen,
      numbered: JSON.stringify(set.pairs.map((pair) => pair.map((i) => i + 1))),
      phase: phase ? `, phase: ${phase}` : '',
    };
  });
  return draw;
});
