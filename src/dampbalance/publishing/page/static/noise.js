/* Noise: many noisy experiments, their estimates, and how much better rows weighted by inverse variance do. */
const noise = (() => {
  'use strict';
  const [ODD, NORMALS, CHI2] = [[1, 3, 5], 8, 5.991]; // χ² of two degrees of freedom that 95 % do not exceed
  const { sum } = kit;

  /* A generator of standard normal numbers, the same ones for the same seed (mulberry32, then Box and Muller). */
  function normals(seed) {
    let state = Math.imul(seed, 2654435761);
    const uniform = () => {
      state = (state + 0x6d2b79f5) | 0;
      let t = Math.imul(state ^ (state >>> 15), 1 | state);
      t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
      return (((t ^ (t >>> 14)) >>> 0) + 0.5) / 4294967296;
    };
    return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
  }

  /* A response with what noise needs of it: its harmonics x_n, e^(inφ) at the reversal at +X, and the standard deviations [of x, of y],
     m, of the real and the imaginary part of a harmonic: white noise that is a share of the rms of its channel, in so many samples. */
  const prepared = (r, share, samples) => ({
    ...r,
    harmonics: ODD.map((n) => [r[`X_${n}`], -r[`phi_${n}`], n * r.phi, n]).map(([X, psi, turn, n]) => [n, X * Math.cos(psi), X * Math.sin(psi), Math.cos(turn), Math.sin(turn)]),
    deviations: [Math.hypot(...ODD.map((n) => r[`X_${n}`])), r.Y].map((rms) => (share * rms) / Math.sqrt(samples)),
  });

  /* A prepared response as it is read with noise: z gives 8 standard normal numbers, of x_1, x_3, x_5 and y, real and imaginary parts,
     one after the other. The contact stiffness is known, so that the onset of slip stays 2 Z_m from the reversal; harmonics above the fifth stay as they are. */
  function noisy(r, z) {
    const { omega, k, harmonics, deviations: [of_x, of_y] } = r;
    let [X, b] = [r.X, r.b];
    const read = harmonics.map(([n, re, im, cos, sin], i) => {
      const [u, v] = [of_x * z(2 * i), of_x * z(2 * i + 1)];
      X += u * cos - v * sin;
      b += Math.PI * omega * n ** 2 * ((re + u) ** 2 - re ** 2 + (im + v) ** 2 - im ** 2);
      return [re + u, im + v];
    });
    const all = [...read, [r.Y + of_y * z(6), of_y * z(7)]];
    const [X_1, X_3, X_5, Y] = all.map(([re, im]) => Math.sqrt(re * re + im * im));
    const phi_fundamental = Math.atan2(all[3][1], all[3][0]) - Math.atan2(all[0][1], all[0][0]);
    const W = Math.PI * k * Y * X_1 * Math.sin(phi_fundamental);
    return { omega, k, Y, X, X_s: r.X_s + r.X - X, X_1, X_3, X_5, phi_fundamental, a: r.a + 4 * (X - r.X), b, W };
  }

  const rowsOf = (approach, responses) => kit.rows(approach, responses, 'fundamental');

  /* How far one standard deviation of each normal number moves the row of every response: per response 8 changes of {a, b, W}. */
  const spread = (approach, responses) => responses.map((r) => Array.from({ length: NORMALS }, (_, i) => {
    const [up, down] = rowsOf(approach, [1, -1].map((by) => noisy(r, (j) => (i === j ? by : 0))));
    return ['a', 'b', 'W'].map((name) => 0.5 * (up[name] - down[name]));
  }));
  /* Variance of a F_k + b c − W of every row. */
  const variances = (moves, { F_k, c }) => moves.map((of) => of.reduce((total, [a, b, W]) => total + (a * F_k + b * c - W) ** 2, 0));

  /* The covariance of (F_k, c) that errors of rows with these variances leave, if the rows are weighted so: the estimates are linear
     in W, and `gains` says how far each row moves them. */
  function predicted(rows, variance, weights) {
    const gains = rows.map((_, n) => kit.solve(rows.map((row, i) => ({ ...row, W: Number(i === n) })), weights));
    return ['F_k', 'c'].map((i) => ['F_k', 'c'].map((j) => sum(gains.map((gain, n) => gain[i] * gain[j] * variance[n]))));
  }

  function statistics(all) {
    const mean = ['F_k', 'c'].map((name) => kit.mean(all.map((one) => one[name])));
    const off = all.map((one) => [one.F_k - mean[0], one.c - mean[1]]);
    return { mean, covariance: [0, 1].map((i) => [0, 1].map((j) => sum(off.map((d) => d[i] * d[j])) / (all.length - 1))) };
  }
  const correlation = (C) => C[0][1] / Math.sqrt(C[0][0] * C[1][1]);
  const ellipse = ([F_k, c], C) => Array.from({ length: 73 }, (_, i) => {
    const [t, s, r] = [(i / 36) * Math.PI, Math.sqrt(CHI2), correlation(C)];
    return [F_k + s * Math.sqrt(C[0][0]) * Math.cos(t), c + s * Math.sqrt(C[1][1]) * (r * Math.cos(t) + Math.sqrt(1 - r * r) * Math.sin(t))];
  });

  /* Experiments: {draws, moves, ways: [equal, weighted]}, of each way {all, mean, covariance, predicted}. */
  function study(responses, { approach, share, samples, count, seed }) {
    const [read, normal] = [responses.map((r) => prepared(r, share, samples)), normals(seed)];
    const draws = Array.from({ length: count }, () => read.map((r) => noisy(r, normal)));
    const [moves, clean] = [spread(approach, read), rowsOf(approach, responses)];
    const variance = variances(moves, kit.solve(clean));
    const rows = draws.map((one) => rowsOf(approach, one));
    const equal = rows.map((one) => kit.solve(one));
    const weighted = equal.map((one, i) => kit.solve(rows[i], variances(moves, one).map((v) => 1 / v))); // by the experiment's own estimate
    return { draws, moves, ways: [[equal, variance.map(() => 1)], [weighted, variance.map((v) => 1 / v)]].map(
      ([all, weights]) => ({ all, ...statistics(all), predicted: predicted(clean, variance, weights) })) };
  }

  const RATE = 1000; // Hz, of the records
  kit.instrument('cloud', (it) => {
    const { percent, rich } = kit;
    const { case: set } = it.data;
    const NAMES = { equal: 'equal weights', weighted: 'weighted by inverse variance' };
    const svg = it.drawing('.cloud', 320);

    function draw({ percent: noise, cycles, count, approach, f, seed }) {
      const responses = set.levels.map((Y) => kit.response(it.engine, { ...set, Y, omega: 2 * Math.PI * f })).filter(({ regime }) => regime === 'one slip');
      it.root.classList.toggle('still', responses.length < 2);
      if (responses.length < 2) { it.write('.words', 'Fewer than two levels slip once in every half cycle at this frequency.'); return; }
      const samples = Math.round((RATE * cycles) / f);
      const { ways } = study(responses, { approach, share: noise / 100, samples, count, seed });
      const truth = [set.F_k, set.c];
      const reach = truth.map((value, i) => 1.25 * Math.max(...ways.map((way) => Math.abs(way.mean[i] - value) + Math.sqrt(CHI2 * way.predicted[i][i]))));
      const [x, y] = truth.map((value, i) => [value - reach[i], value + reach[i]]);
      const plane = kit.plot(svg, { x, y, labels: ['F_k, N', 'c, N s/m'], truth });
      Object.keys(NAMES).forEach((css, i) => {
        const { all, mean, covariance, predicted: expected } = ways[i];
        plane.line([], `points ${css}`).setAttribute('d', all.map((one) => `${plane.path([[one.F_k, one.c]])}h0`).join(''));
        plane.line(ellipse(mean, covariance), css);
        plane.line(ellipse(mean, expected), `${css} predicted`);
      });
      const cells = (way) => truth.flatMap((value, i) => [
        percent(way.mean[i] / value - 1), ...[way.covariance, way.predicted].map((C) => percent(Math.sqrt(C[i][i]) / value, '')),
      ]).map((text) => `<td class="num">${text}</td>`).join('');
      it.write('tbody', Object.values(NAMES).map((words, i) => `<tr><th scope="row">${words}</th>${cells(ways[i])}<td class="num">${correlation(ways[i].covariance).toFixed(3).replace('-', '−')}</td></tr>`).join(''));
      const [F_k, c] = [0, 1].map((i) => percent(ways[1].predicted[i][i] / ways[0].predicted[i][i], ''));
      it.write('.words', `Weighting lowers the variance of ${rich('F_k')} to <b>${F_k}</b> of what equal weights, as in the paper’s Eq. (9), leave, and that of <i>c</i> to ${c}: unweighted, the highest level counts most, and it has the largest errors. Each record holds ${samples} samples.`);
    }

    it.code(() => ({ rate: RATE, share: it.values.percent / 100 }));
    return draw;
  });
  return { normals, study };
})();
if (typeof module !== 'undefined') module.exports = noise;
