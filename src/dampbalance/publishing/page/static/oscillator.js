/* The oscillator lives: its parts move, two loops fill with the energy lost in a cycle, and the balance closes. */
kit.instrument('oscillator', (it) => {
  'use strict';
  const { number, rich } = kit;
  const [POINTS, SECONDS] = [401, 4]; // of a cycle: computed, and on the screen
  const [SWING, FLEX] = [34, 11]; // px: of what moves most, and of the contact spring, whose microns would not be seen
  const REGIMES = {
    'one slip': 'The contact slips once in every half cycle.',
    'several slips': 'The contact sticks and slips several times in every half cycle.',
    'no slip': 'The contact only sticks: it is a spring, and dissipates no energy.',
    'no friction': 'There is no friction: the contact slips all the time, and dissipates nothing.',
    'not found': 'No steady motion: the base puts in more than friction and damper can dissipate.',
  };
  const UNITS = { // of the readings: how many of the unit shown are in the SI unit
    X: [1e3, 'mm'], X_s: [1e3, 'mm'], V_s: [1e3, 'mm/s'], t_s: [1e3, 'ms'], phi: [1, 'rad'], a: [1e3, 'mm'], b: [1e6, 'mm²/s'], Z_m: [1e6, 'µm'],
  };
  const parameters = ({ Y, f, ...others } = it.values) => ({ ...it.data.case, ...others, Y: Y / 1000, omega: 2 * Math.PI * f });
  const planes = ['.contact', '.viscous', '.velocity'].map((one) => it.drawing(one, 230));
  const parts = ['.spring', '.contact-spring', '.base', '.mass', '.part.slider'].map(it.find);
  const bars = Object.fromEntries([...it.root.querySelectorAll('rect[class]')].map((one) => [one.getAttribute('class'), one]));
  const [phase, toggle, state] = ['.phase', '.toggle', '.state'].map(it.find);
  let [cycle, marks, playing, visible, last] = [null, [], false, false, 0];

  // Force times path up to each point, as a share of W; scaled to the exact work of a whole cycle.
  const share = (force, path, whole, W) => {
    let sum = 0;
    const sums = force.map((f, i) => (sum += i ? 0.5 * (f + force[i - 1]) * (path[i] - path[i - 1]) : 0));
    return sums.map((s) => (sum ? (s * whole) / sum / W : 0));
  };

  function draw() {
    const par = parameters();
    const r = kit.response(it.engine, par);
    const found = r.regime !== 'not found';
    const [lost, damped] = [(r.a || 0) * par.F_k, r.b * par.c];
    const energy = (J) => `${number(1e3 * J, 5)}\u00a0mJ (${number((100 * J) / r.W, 3)}\u00a0%)`;
    it.write('.words', REGIMES[r.regime] + (found ? ` In a cycle the base puts in <b><i>W</i> = ${number(1e3 * r.W, 5)}\u00a0mJ</b>. Friction dissipates
      <b><i>a</i>\u00a0${rich('F_k')} = ${energy(lost)}</b>, the damper <b><i>b</i>\u00a0<i>c</i> = ${energy(damped)}</b>: the balance closes within
      ${number(Math.max(2.2e-16, Math.abs(r.W - lost - damped) / r.W), 1)} of <i>W</i>.` : ''));
    for (const [name, [scale, unit]] of Object.entries(UNITS)) it.write(`[data-name=${name}]`, `${number(scale * r[name], 5)}\u00a0${unit}`);
    it.root.classList.toggle('still', !found);
    cycle = found ? it.engine.cycle(par, POINTS) : null;
    if (!found) return;
    const [x, v, f, d, push] = [['x', 1e3], ['v', 1], ['z', par.K_z], ['v', par.c], ['y', par.k]].map(([name, scale]) => Array.from(cycle[name], (u) => scale * u));
    Object.assign(cycle, { r, par, input: share(push, x, r.W, r.W), friction: share(f, x, lost, r.W), damper: share(d, x, damped, r.W) });
    const around = (values) => { const most = 1.12 * (Math.max(...values.map(Math.abs)) || 1); return [-most, most]; };
    const drawn = [[x, f, 'x, mm', 'f, N'], [x, d, 'x, mm', 'c ẋ, N'], [v, [...f, ...d], 'ẋ, m/s', 'f and c ẋ, N']].map(
      ([us, forces, ...labels], n) => kit.plot(planes[n], { x: around(us), y: around(forces), labels }));
    marks = [[0, x, f, 'friction'], [1, x, d, 'damper'], [2, v, f, 'friction'], [2, v, d, 'damper']].map(([n, us, forces, css]) => {
      const [plane, all] = [drawn[n], us.map((u, i) => [u, forces[i]])];
      if (n < 2) plane.area(all, `${css} whole`);
      const filled = n < 2 ? plane.area([], css) : null;
      plane.line(all, css);
      return { plane, all, filled, dot: plane.dot(...all[0], css) };
    });
    frame();
  }

  function frame() {
    if (!cycle) return;
    const { x, y, z, r, par } = cycle;
    const i = Math.round((phase.value / 360) * (POINTS - 1));
    phase.setAttribute('aria-valuetext', `${Math.round(phase.value)}°`);
    for (const { plane, all, filled, dot } of marks) {
      dot.setAttribute('transform', `translate(${plane.X(all[i][0])} ${plane.Y(all[i][1])})`);
      // down to the axis of no force: the area is the work so far, ∫ f dx
      filled?.setAttribute('d', `${plane.path([...all.slice(0, i + 1), [all[i][0], 0], [all[0][0], 0]])}Z`);
    }
    const scale = SWING / Math.max(r.X, par.Y);
    const slider = scale * (x[i] - z[i]); // at rest while the contact sticks
    const mass = slider + (r.Z_m ? Math.max(scale, FLEX / r.Z_m) : 0) * z[i];
    const [b, m, s] = [50 + scale * y[i], 220 + mass, 480 + slider];
    [[b + 30, (m - b - 30) / 100], [m + 110, (s - m - 110) / 100], [b], [m], [s]].forEach(([at, stretch = 1], n) => {
      parts[n].setAttribute('transform', `translate(${at.toFixed(2)} 0) scale(${stretch.toFixed(4)} 1)`);
    });
    const sticks = Math.abs(z[i]) < r.Z_m * (1 - 1e-9);
    it.root.classList.toggle('sticks', sticks);
    state.textContent = sticks ? 'The contact sticks.' : 'The contact slips.';
    for (const [whole, at] of [['', i], [' whole', POINTS - 1]]) { // so far, and in all of the cycle
      const places = { input: [0, Math.min(1, cycle.input[at])], friction: [0, cycle.friction[at]], damper: [cycle.friction.at(-1), cycle.damper[at]] };
      for (const [name, [from, width]] of Object.entries(places)) {
        bars[name + whole].setAttribute('x', from);
        bars[name + whole].setAttribute('width', Math.max(0, width));
      }
    }
  }

  const tick = (now) => {
    if (!playing || !visible) return;
    phase.value = (Number(phase.value) + (0.36 * Math.min(now - last, 100)) / SECONDS) % 360;
    last = now;
    frame();
    requestAnimationFrame(tick);
  };
  const play = (on) => {
    [playing, last] = [on, performance.now()];
    toggle.textContent = on ? 'Pause' : 'Play';
    requestAnimationFrame(tick);
  };
  toggle.addEventListener('click', () => play(!playing));
  phase.addEventListener('input', () => { play(false); frame(); });
  new IntersectionObserver(([{ isIntersecting }]) => { visible = isIntersecting; play(playing); }).observe(it.find('.scene'));
  play(!matchMedia('(prefers-reduced-motion: reduce)').matches);

  it.code(() => {
    const par = parameters();
    return { ...par, levels: [par.Y, 2 * par.Y] };
  });
  return draw;
});
