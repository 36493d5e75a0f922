"""Stepped-sine tables of bolted joints: Iwan's four-parameter model and single sliders, from their own formulas.

The joint of D. J. Segalman (2005, J. Appl. Mech. 72, 752) has sliders whose break-free displacement φ is distributed by

    ρ(φ) = R φ^χ for φ < φ_max,  and S δ(φ − φ_max)
    φ_max = F_S (1 + β)/(K_T (β + q)),  S φ_max (1 + q/β) = F_S,  R φ_max^{χ+2} (β + q) = (χ + 1) F_S

with q = (χ + 1)/(χ + 2).

Its loss per cycle is the quadrature of 4(X − φ)φρ(φ), its stiffness that of the branches that Masing's rule gives,
F(x) = F_b(X) − 2F_b((X − x)/2) on the way back, F_b the force of the first loading. Nothing of the package is used for
the tables.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from dampbalance.fit.contacts import ContactFit, compare_contacts
from dampbalance.fit.stiffness_lines import StiffnessLines
from dampbalance.project.wording import markdown_table

from .score import share
from .truths import log_uniform

_JOINTS = 5  # so that the draws are not those of other sets
_ANGLES = (np.arange(200) + 0.5) * math.pi / 200  # of a half cycle
_GAUSS = np.polynomial.legendre.leggauss(80)
_INSIDE = 9  # amplitudes at which the loss is compared
IWAN, SLIDER = "Iwan", "one slider"
NOISE = (0.003, 0.01, 0.03)
_SYMBOLS = ("F_k", "c", "K_z", "k", "m")


@dataclass(frozen=True)
class Iwan:
    """Segalman's joint.   F_S : N.   K_T : N/m.   chi, beta : no unit."""

    F_S: float
    K_T: float
    chi: float
    beta: float

    @property
    def largest(self) -> float:
        """φ_max, m."""
        q = (self.chi + 1.0) / (self.chi + 2.0)
        return self.F_S * (1.0 + self.beta) / (self.K_T * (self.beta + q))

    def _density(self) -> tuple[float, float]:
        """Return R and S."""
        q = (self.chi + 1.0) / (self.chi + 2.0)
        R = self.F_S * (self.chi + 1.0) / (self.largest ** (self.chi + 2.0) * (self.beta + q))
        return R, self.F_S / self.largest * self.beta / (self.beta + q)

    def first_loading(self, x: np.ndarray) -> np.ndarray:
        """Return F_b, N."""
        R, S = self._density()
        chi, u = self.chi, np.minimum(x, self.largest)
        slipped = R * u ** (chi + 2.0) / (chi + 2.0)
        held = R * (self.largest ** (chi + 1.0) - u ** (chi + 1.0)) / (chi + 1.0) + S
        return np.asarray(slipped + u * held)

    def loss(self, X: float) -> float:
        """Return energy per cycle, J."""
        R, S = self._density()
        top = min(X, self.largest)
        # φ = top s^{1/(χ + 1)} takes the singularity of φ^χ away
        s = 0.5 * (_GAUSS[0] + 1.0)
        phi = top * s ** (1.0 / (self.chi + 1.0))
        weight = 0.5 * _GAUSS[1] * R * top ** (self.chi + 1.0) / (self.chi + 1.0)
        jump = 4.0 * S * self.largest * max(X - self.largest, 0.0)
        return float(weight @ (4.0 * phi * (X - phi))) + jump

    def in_phase(self, X: float) -> float:
        """Return stiffness of the fundamental, N/m."""
        x = X * np.cos(_ANGLES)
        force = self.first_loading(np.array(X)) - 2.0 * self.first_loading(0.5 * (X - x))
        return float(2.0 * np.mean(force * np.cos(_ANGLES)) / X)


@dataclass(frozen=True)
class Slider:
    """A single Jenkins element.   F_k : N.   K_z : N/m."""

    F_k: float
    K_z: float

    def loss(self, X: float) -> float:
        """Return energy per cycle, J."""
        return 4.0 * self.F_k * max(X - self.F_k / self.K_z, 0.0)

    def in_phase(self, X: float) -> float:
        """Return stiffness of the fundamental, N/m, from the corners of the parallelogram."""
        x = X * np.cos(_ANGLES)
        force = np.maximum(self.K_z * (x - X) + min(self.F_k, self.K_z * X), -self.F_k)
        return float(2.0 * np.mean(force * np.cos(_ANGLES)) / X)


@dataclass(frozen=True)
class Truth:
    """One table: an oscillator with a joint, and how it is driven.   forces : of the levels, N.   omega : rad/s."""

    index: int
    kind: str
    m: float
    k: float
    c: float
    k_3: float
    joint: Iwan | Slider
    forces: tuple[float, ...]
    omega: tuple[tuple[float, ...], ...]
    noise: float

    def loss(self, X: float, omega: float) -> float:
        """Return energy per cycle, J."""
        return self.joint.loss(X) + math.pi * self.c * omega * X**2

    def in_phase(self, X: float) -> float:
        """Return stiffness of the fundamental, N/m."""
        return self.k + 0.75 * self.k_3 * X**2 + self.joint.in_phase(X)

    def Z(self, X: float, omega: float) -> complex:
        """Return dynamic stiffness, N/m."""
        quadrature = self.loss(X, omega) / (math.pi * X**2)
        return complex(self.in_phase(X) - self.m * omega**2, quadrature)

    def amplitude(self, force: float, omega: float, largest: float) -> float:
        """Return X that a force drives, m."""

        def excess(ln_X: float) -> float:
            X = math.exp(ln_X)
            return math.log(abs(self.Z(X, omega)) * X / force)

        top = math.log(largest)
        return math.exp(brentq(excess, top - 25.0, top + 5.0, xtol=1e-9))


def draw(index: int, seed: int) -> Truth:
    """Set `index`: half of them Iwan joints, half single sliders; ζ 0.1–1 %, K/k 0.02–1, 3–12 levels over a ratio of
    amplitudes of 5–30, 5–41 lines a level within ±1.5 half-power bandwidths of resonance."""
    random = np.random.default_rng((_JOINTS, seed, index))
    spread = log_uniform(random)
    m, f_n, largest = spread(0.1, 10.0), spread(5.0, 200.0), spread(1e-5, 1e-3)
    omega_n = 2.0 * math.pi * f_n
    k = m * omega_n**2
    kind = IWAN if index % 2 else SLIDER
    K = k * spread(0.02, 1.0)
    levels, points = int(random.integers(3, 13)), int(random.integers(5, 42))
    ratio = spread(5.0, 30.0)
    joint: Iwan | Slider
    if kind == IWAN:
        chi, beta = random.uniform(-0.8, 0.2), spread(0.05, 5.0)
        unit = Iwan(1.0, K, chi, beta)
        joint = Iwan(largest * spread(0.6, 20.0) / unit.largest, K, chi, beta)
    else:
        r = largest * spread(0.02, 0.6)
        joint = Slider(K * r, K)
    zeta = spread(0.001, 0.01)
    k_3 = k / largest**2 * spread(0.001, 0.1) if random.random() < 0.5 else 0.0
    c = 2.0 * zeta * m * omega_n
    truth = Truth(index, kind, m, k, c, k_3, joint, (), (), NOISE[int(random.integers(3))])
    X = largest * np.geomspace(1.0 / ratio, 1.0, levels)
    resonance = [math.sqrt(truth.in_phase(x) / m) for x in X]
    forces = tuple(truth.Z(x, w).imag * x for x, w in zip(X, resonance, strict=True))
    width = max(truth.Z(x, w).imag / (2.0 * m * w) for x, w in zip(X, resonance, strict=True))
    if random.random() < 0.5:
        ends = [(min(resonance) - 1.5 * width, max(resonance) + 1.5 * width)] * levels
    else:
        ends = [(w - 1.5 * width, w + 1.5 * width) for w in resonance]
    lines = [np.linspace(max(low, 0.2 * omega_n), high, points) for low, high in ends]
    omega = tuple(tuple(one.tolist()) for one in lines)
    return replace(truth, forces=forces, omega=omega)


def table_of(truth: Truth, seed: int) -> StiffnessLines:
    """Return the lines, with noise on the real and the imaginary part of each Z, as a part of |Z|."""
    largest = 1e-3
    rows = [
        (w, truth.amplitude(force, w, largest), level)
        for level, force in enumerate(truth.forces)
        for w in truth.omega[level]
    ]
    omega, X, level = (np.array(values) for values in zip(*rows, strict=True))
    Z = np.array([truth.Z(x, w) for x, w in zip(X, omega, strict=True)])
    random = np.random.default_rng((_JOINTS, seed, truth.index, 1))
    noise = random.standard_normal((2, Z.size)) * truth.noise
    names = tuple(f"level {i + 1}" for i in range(len(truth.forces)))
    return StiffnessLines(omega, X, Z * (1.0 + noise[0] + 1j * noise[1]), level, names)


def outcome(run: tuple[int, int]) -> list[dict[str, object]]:
    """Return one row of a set, by its number and the seed: what was drawn, what is supported, errors and coverage."""
    index, seed = run
    truth = draw(index, seed)
    lines = table_of(truth, seed)
    began = time.process_time()
    try:
        compared = compare_contacts(lines)
    except ValueError as error:  # a refusal is an outcome, too
        return [{"set": index, "kind": truth.kind, "refused": str(error)}]
    fit = compared.fits["gradual" if truth.kind == IWAN else "one slider"]
    row: dict[str, object] = {
        "set": index,
        "kind": truth.kind,
        "noise": truth.noise,
        "levels": len(truth.forces),
        "lines": lines.X.size,
        "refused": "",
        "supported": compared.supported,
        "weight": compared.weights[compared.supported],
        "seconds": time.process_time() - began,
    }
    row |= _bands(truth, fit)
    if isinstance(truth.joint, Slider):
        known = {"F_k": truth.joint.F_k, "K_z": truth.joint.K_z}
        for symbol, true in {**known, "c": truth.c, "k": truth.k, "m": truth.m}.items():
            low, high = fit.interval(symbol)
            row[symbol] = low <= true <= high
    return [row]


def _bands(truth: Truth, fit: ContactFit) -> dict[str, object]:
    """Return Error of the loss within the range, at resonance, and the shares of bands that hold the truth."""
    X = np.geomspace(*fit.X_range, _INSIDE)
    stiffness = np.array([truth.in_phase(x) for x in X])
    omega = np.sqrt(stiffness / truth.m)
    loss = np.array([truth.loss(x, w) for x, w in zip(X, omega, strict=True)])
    (Z, reach), (K, reach_of_K) = fit.law(X, omega), fit.law(X, 0.0)
    of_loss = math.pi * X**2 * Z.imag
    held = [float(np.mean(np.abs(of_loss - loss) <= math.pi * X**2 * reach.imag))]
    held.append(float(np.mean(np.abs(K.real - stiffness) <= reach_of_K.real)))
    error = float(np.sqrt(np.mean((of_loss / loss - 1.0) ** 2)))
    return {"error": error, "loss_held": held[0], "stiffness_held": held[1]}


def table(rows: pd.DataFrame) -> str:
    """Return Errors and coverage by joint and noise, and which contact was supported, in markdown."""
    fits = rows[rows["refused"] == ""]
    heads = [
        "joint, fitted as it is",
        "noise",
        "sets",
        "rms error of the loss in range: median, 90 %",
    ]
    heads += ["bands of the loss that hold it", "of the stiffness"]
    lines = []
    for kind, of_kind in fits.groupby("kind"):
        for noise, some in [*of_kind.groupby("noise"), ("all", of_kind)]:
            median, most = 100.0 * some["error"].quantile([0.5, 0.9])
            held = [
                f"{100.0 * some[name].mean():.1f} %" for name in ("loss_held", "stiffness_held")
            ]
            of = str(noise) if noise == "all" else f"{100.0 * float(noise):g} %"
            lines.append([str(kind), of, str(len(some)), f"{median:.2g} %, {most:.2g} %", *held])
    parts = [markdown_table(heads, lines)]
    single = fits[fits["kind"] == SLIDER]
    cells = []
    for symbol in _SYMBOLS:
        cells.append([symbol, share(single[symbol])])
    parts.append(markdown_table(["single sliders", "intervals that hold the truth, %"], cells))
    names = ["one slider", "gradual", "no contact", "refused"]
    counts = []
    for kind, some in rows.groupby("kind"):
        own = some["supported"].where(some["supported"].isin(names[:2]), "no contact")
        own = own.where(some["refused"] == "", "refused")
        counts.append([str(kind), *(str(int((own == name).sum())) for name in names)])
    parts.append(markdown_table(["joint", *(f"supported: {name}" for name in names)], counts))
    seconds = fits["seconds"]
    parts.append(
        f"Processor time of a comparison: {seconds.median():.1f} s (median), {seconds.max():.1f} s at the most."
    )
    return "\n\n".join(parts) + "\n"
