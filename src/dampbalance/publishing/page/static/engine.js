// The kernels of the package, compiled to WebAssembly: see publishing/engine.py, which says how they are called.
// Numbers go in and come out in SI units, under the names that they have in Python.
async function loadEngine(bytes) {
  const PARAMETERS = ["m", "c", "k", "K_z", "F_k", "Y", "omega"];
  const MEASURES = ["X", "X_s", "V_s", "t_s", "phi", "phi_zero_crossing", "a", "b", "W",
    "X_1", "phi_1", "X_3", "phi_3", "X_5", "phi_5"];
  const REGIMES = ["not found", "one slip", "several slips", "no slip", "no friction"];
  const [NO_CLOSED_FORM, MAX_PHASES, MOST_RADIANS, PHASE_COLUMNS, STATE_ROWS] = [255, 16384, 2e7, 5, 4];
  const { exports: kernels } = (await WebAssembly.instantiate(bytes)).instance;
  let result = 0;

  // A new array of zeros in the memory of the kernels, which forget all arrays at `reset`.
  function array(...shape) {
    const size = shape.reduce((product, n) => product * n, 1);
    const address = kernels.reserve(8 * size);
    const strides = shape.map((_, axis) => shape.slice(axis + 1).reduce((product, n) => product * n, 8));
    const view = () => new Float64Array(kernels.memory.buffer, address, size); // memory that grows moves
    view().fill(0);
    return { view, argument: [0, 0, BigInt(size), 8n, address, ...shape.map(BigInt), ...strides.map(BigInt)] };
  }

  function reset() {
    kernels.reset();
    result = kernels.reserve(256); // of what a kernel returns; the message of an exception comes last
  }

  // What a kernel returns: a view of its tuple, eight bytes for each member.
  function call(kernel, ...given) {
    if (kernels[kernel](result, result + 248, ...given.flat())) throw new Error(`${kernel} failed`);
    return new DataView(kernels.memory.buffer, result, 248);
  }

  const numbers = (parameters) => PARAMETERS.map((name) => {
    if (!Number.isFinite(parameters[name])) throw new Error(`${name} must be a number`);
    return parameters[name];
  });

  // The steady orbit: its regime, the number of phases of its half cycle, the phases, and θ at the reversal at −X.
  function orbit(par) {
    reset();
    let phases = array(2, PHASE_COLUMNS);
    let solved = call("solve_closed", par, phases.argument);
    if (Number(solved.getBigInt64(0, true)) === NO_CLOSED_FORM) {
      phases = array(MAX_PHASES, PHASE_COLUMNS);
      solved = call("solve_otherwise", par, phases.argument, MOST_RADIANS);
    }
    const [regime, count] = [0, 8].map((place) => Number(solved.getBigInt64(place, true)));
    return { regime, count, phases, theta: solved.getFloat64(16, true) };
  }

  function steady(parameters) {
    const par = numbers(parameters);
    const { regime, count, phases, theta } = orbit(par);
    const read = count && call("measure", phases.argument, BigInt(count), theta, par);
    const measured = Object.fromEntries(MEASURES.map((name, i) => [name, count ? read.getFloat64(8 * i, true) : NaN]));
    return { regime: REGIMES[regime], Z_m: parameters.F_k / parameters.K_z, ...measured, phi_fundamental: measured.phi_1 };
  }

  // One period from the reversal at −X on, both ends included; t counts from that reversal.
  function cycle(parameters, points) {
    const par = numbers(parameters);
    const { count, phases, theta } = orbit(par);
    const half = Math.PI / parameters.omega;
    const mirrored = (i) => 2 * i >= points - 1;
    const t = Float64Array.from({ length: points }, (_, i) => 2 * half * i / (points - 1));
    const times = array(points);
    times.view().set(t.map((at, i) => (mirrored(i) ? at - half : at)));
    phases.argument[5] = BigInt(count);
    const out = Number(call("states_in_phases", times.argument, phases.argument, theta, par).getUint32(24, true));
    const states = new Float64Array(kernels.memory.buffer, out, STATE_ROWS * points);
    const [x, v, acceleration, z] = [0, 1, 2, 3].map((row) => t.map((_, i) => (mirrored(i) ? -1 : 1) * states[row * points + i]));
    return { t, x, v, acceleration, z, y: t.map((at) => parameters.Y * Math.cos(theta + parameters.omega * at)) };
  }

  return { steady, cycle };
}

if (typeof module !== "undefined") module.exports = { loadEngine };
