"""Maximum-likelihood fit of one oscillator to all records: the exact waveforms that fit their harmonics best.

The waveform of a record is the steady response of the oscillator (m, k, K_z, F_k) with a damping law, F_k and c by
default, under y = Y cos ωt. The stiffness k is given; the coefficients of the law, ρ = K_z^{−1/2} and, unless
it is given, the mass m are common to all records, Y and the phase ψ of the base are each record's own. Where the noise
is white, harmonics taken by least squares over whole cycles hold all the information on a steady motion, so that

    χ² = Σ |x_n(model) e^{inψ} − x_n|²/σ_n² + (Y(model) − Y)²/σ_Y² + (Yψ)²/σ_Y²

is that of the fit to all samples, whatever drives, whatever answers and however long the record is. Its minimum is the
estimate of largest likelihood; χ² itself says whether the records are those of such an oscillator. Any regime has its
exact waveform: one slip onset per half cycle, several, none. In ρ the rigid contact, ρ = 0, is a regular point.

The harmonics fix the phase of the base, too: a time by which the response lags the base in the record (a skew between
two channels) turns harmonic n by n times its angle, and can be left free.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complexes, Mask
from ..law.law import Law
from ..law.terms import FRICTION, term
from ..model import BaseMotion, NoOscillator, Oscillator
from ..motion.law_steady import Response, steady_response
from ..motion.orbit import NoSteadyOrbit
from ..signals.lines import Lines
from ..signals.mean_harmonics import Waveform
from .climb import ClimbBounds
from .goodness import improbable
from .oscillator_fit import OscillatorFit

_BEYOND_THE_LAW = (
    "rho",
    "m",
    "delay",
)  # common unknowns in addition to the coefficients of the law
NO_MOTION = (ArithmeticError, NoOscillator, np.linalg.LinAlgError)
"""Errors of a point that has no motion to fit: no steady orbit, which is an ArithmeticError like a division by zero on
the way to one, a number out of range, or equations without a solution. Any other error is a defect, and shows."""

MOST_RADIANS_SEARCHED = 5e5
"""Of the fastest motion that are followed in search of one orbit: a quarter of a second."""

# Of K_z/k: the contact that stands for a rigid one. It sticks for 10⁻⁵ rad of the cycle or so, by which friction comes
# late: to tell that from nothing takes noise below 10⁻⁶ of the motion.
STIFFEST = 1e10
TURNS_PER_EVALUATION = (
    200.0  # turns of the fastest motion, which cost as much as the rest of an evaluation
)
_MOST_TURNS = 2e4  # of an orbit whose derivatives are computed: 0.1 s
_MOST_PHASES_FITTED = 64  # of half a cycle: to follow a contact that rattles on takes long
_GAIN_WHEN_CONVERGED = 5e-3  # in −log L: half the square of a tenth of a standard error
_HARMONICS_OF_WAVEFORM = (
    128  # odd ones of the waveform: beyond them lies less than 1e-6 of its velocity
)


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The unknowns of `law` for the records with these harmonics: their places in a point, and the motion that follows.

    Common to all records, or to a group of them, are the coefficients of the law, ρ = K_z^{−1/2}, the mass m and a
    delay; Y and the phase ψ of the base are each record's own. The stiffness k, N/m, is given.
    """

    law: Law
    lines: tuple[Lines, ...]
    k: float

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the common unknowns: the keys of the coefficients, rho, m and delay."""
        return (*self.law.keys, *_BEYOND_THE_LAW)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.names) + 2 * len(self.lines)

    @cached_property
    def at(self) -> list[dict[str, int]]:
        """Places of the unknowns of each record: those of its law by symbol, rho, m, delay, Y and psi."""
        places = []
        for i in range(len(self.lines)):
            common = {s: self.names.index(self.law.key(s, i)) for s in self.law.terms}
            others = {name: self.names.index(name) for name in _BEYOND_THE_LAW}
            own = len(self.names) + 2 * i
            places.append(common | others | {"Y": own, "psi": own + 1})
        return places

    def equivalents(self, symbol: str) -> Array:
        """`equivalent_coefficient` of a term in each record, (n,)."""
        return np.array([equivalent_coefficient(symbol, one, self.k) for one in self.lines])

    def friction(self, points: Array) -> Array:
        """F_k of points, (p, …), N; the mean over the groups, where it has some."""
        places = [self.names.index(key) for key in self.law.keys_of(FRICTION)]
        return points[places].mean(axis=0)

    def response(self, point: Array, record: int, near: Response | None = None) -> Response:
        """The motion of a record.   near : a motion from which to start.   Raises NO_MOTION."""
        value = {name: float(point[at]) for name, at in self.at[record].items()}
        law: dict[str, float] = {s: value[s] for s in self.law.terms if s not in (FRICTION, "c")}
        oscillator = Oscillator(
            value["m"], value.get("c", 0.0), self.k, value["rho"] ** -2, value[FRICTION]
        )
        motion = BaseMotion(value["Y"], self.lines[record].omega)
        return steady_response(oscillator, motion, law, near, most_radians=MOST_RADIANS_SEARCHED)

    def harmonics(
        self, point: Array, record: int, response: Response, count: int
    ) -> tuple[Complexes, Complexes]:
        """Harmonics n = 1, 3 … of a record, turned by ψ, m, (count,), and their derivatives, (count, unknowns).

        By Y because x is homogeneous: of degree one in Y and in p_j^{1/(1 − d_j)}, d_j the order of the term, so that
        Y ∂x/∂Y = x − Σ (1 − d_j) p_j ∂x/∂p_j.
        """
        at = self.at[record]
        x, known = response.with_slopes(count, self.law.terms)
        slope = self._slopes(record, x, known)
        n = np.arange(1, 2 * count, 2)
        slope[:, at["Y"]] = self._by_base(point, record, x, slope)
        slope[:, at["psi"]] = 1j * n * x
        turn = np.exp(1j * n * point[at["psi"]])
        return x * turn, slope * turn[:, None]

    def onset(self, point: Array, record: int, response: Response) -> tuple[Array, Array]:
        """(V_s, t_s, λ), SI, λ = 4X − a, and their derivatives, (3, unknowns)."""
        onset = np.array([response.V_s, response.t_s, response.stick_travel])
        slope = self._slopes(record, onset, response.onset_slopes(self.law.terms))
        of_degree_one = np.array([1.0, 0.0, 1.0]) * onset
        slope[:, self.at[record]["Y"]] = self._by_base(point, record, of_degree_one, slope)
        return onset, slope

    def _slopes(
        self, record: int, here: NDArray[Any], known: Mapping[str, NDArray[Any]]
    ) -> NDArray[Any]:
        """Derivatives of what is read off a motion by all unknowns, from those by the coefficients of its record."""
        slope = np.zeros((here.size, self.size), dtype=here.dtype)
        for name, by in known.items():
            slope[:, self.at[record][name]] = by
        return slope

    def _by_base(self, point: Array, record: int, value: Any, slope: Any) -> Any:
        at = self.at[record]
        for symbol in self.law.terms:
            power = 1 - term(symbol).order
            if power:
                value = value - power * point[at[symbol]] * slope[:, at[symbol]]
        return value / point[at["Y"]]

    def start(self, candidate: Array, relative: Array) -> Array:
        """The point of an oscillator (F_k, c, K_z, m) of `starts`.

        relative : friction of each record over F_k.   The work of c is shared out among the terms that are not given.
        """
        F_k, c, K_z, m = candidate.tolist()
        law, point = self.law, np.zeros(self.size)
        equivalents: dict[str, float] = {
            s: float(np.median(self.equivalents(s))) for s in law.terms
        }
        known = math.fsum(p / equivalents[s] for s, p in law.given.items() if s != FRICTION)
        free = [s for s in law.terms[1:] if s not in law.given]
        for i, one in enumerate(self.lines):
            at = self.at[i]
            point[at[FRICTION]] = law.given.get(FRICTION, F_k * relative[i])
            for s in law.terms[1:]:
                share = max(c - known, 0.0) / max(1, len(free)) * equivalents[s]
                point[at[s]] = law.given.get(s, share)
            point[at["rho"]], point[at["m"]], point[at["Y"]] = K_z**-0.5, m, one.Y
        return point

    def bounds(self, point: Array, free: Mask) -> ClimbBounds:
        """The bounds of a climb from a point; the least ρ stands for a rigid contact."""
        least, scale = np.zeros(self.size), np.ones(self.size)
        for i, one in enumerate(self.lines):
            at = self.at[i]
            small = 1e-3 * math.sqrt(self.k * point[at["m"]])
            for symbol in self.law.terms[1:]:
                scale[at[symbol]] = small * equivalent_coefficient(symbol, one, self.k)
            for name, part, size in ((FRICTION, 1e-9, 1.0), ("rho", 0.0, 1e-3), ("m", 1e-6, 1.0)):
                least[at[name]], scale[at[name]] = part * point[at[name]], size * point[at[name]]
            least[at["rho"]] = 1.0 / math.sqrt(STIFFEST * self.k)
            least[at["psi"]] = least[at["delay"]] = -math.inf
            least[at["Y"]], scale[at["Y"]] = 1e-3 * one.Y, one.Y
        scale[self.names.index("delay")] = 1e-3 / max(one.omega for one in self.lines)
        return ClimbBounds(free, least, np.full(self.size, math.inf), scale)


def equivalent_coefficient(symbol: str, one: Lines, k: float) -> float:
    """Coefficient of a term that dissipates about as much in a record as a damper of 1 N s/m, from its fundamental."""
    if symbol == FRICTION:
        return 1.0
    X = abs(one.x[0])
    viscous: float = math.pi * one.omega * X**2
    return viscous / float(term(symbol).harmonic(one.omega, X, 0.0, 0.0, k))


@dataclass(frozen=True, eq=False)
class HarmonicResiduals:
    """Residuals (model − data)/σ of the harmonics of all records as functions of the unknowns.

    softening : part of the amplitudes added to the errors.
    budget : evaluations that may still be made, (1,), changed by each: a light mass that swings on while it sticks
    takes as long as many others, and ends the climb early.
    near : the last motion of each record, from which the next starts.
    """

    unknowns: Unknowns
    softening: float
    budget: Array = field(default_factory=lambda: np.array([math.inf]))
    near: dict[int, Response] = field(default_factory=dict)

    def products(self, point: Array, out: Array) -> bool:
        """Set `out` to the products of derivatives and residuals, as `climb` takes them."""
        whole = self.evaluate(point)
        if whole is not None:
            np.matmul(whole.T, whole, out=out)
        return whole is not None

    def evaluate(self, point: Array) -> Array | None:
        """Derivatives of the residuals and, in the last column, the residuals themselves, (n, p + 1); None where
        nothing slips, there is no orbit, the contact rattles, or no evaluation is left."""
        if self.budget[0] <= 0.0:
            return None
        blocks = []
        slips = False
        for i in range(len(self.unknowns.lines)):
            try:
                response = self._response(point, i)
                blocks.append(self._block(point, i, response))
            except NO_MOTION:
                return None
            slips |= response.slips
        return np.vstack(blocks) if slips else None

    def _response(self, point: Array, i: int) -> Response:
        """The motion of a record.   Raises NO_MOTION, perhaps after a long search."""
        try:
            response = self.unknowns.response(point, i, self.near.get(i))
        except NoSteadyOrbit:
            self._spend(MOST_RADIANS_SEARCHED / (2.0 * math.pi * TURNS_PER_EVALUATION))
            raise
        self.near[i] = response
        par = response.orbit.parameters
        # or the decay of a velocity by e^{2π} where a light mass creeps in a strong damper
        turns = max(response.swings, 0.5 * par.c / par.m / par.omega)
        if len(response.orbit.phases) > _MOST_PHASES_FITTED or turns > _MOST_TURNS:
            raise NoSteadyOrbit("the contact rattles")
        self._spend(1.0 + turns / TURNS_PER_EVALUATION)
        return response

    def _spend(self, cost: float) -> None:
        self.budget[0] -= cost / len(self.unknowns.lines)

    def _block(self, point: Array, i: int, response: Response) -> Array:
        """The rows of a record: |Y|, its phase, Re x_n, Im x_n."""
        unknowns, one = self.unknowns, self.unknowns.lines[i]
        x, by = unknowns.harmonics(point, i, response, one.n.size)
        at, delay = unknowns.at[i], unknowns.at[i]["delay"]
        error = np.hypot(one.x_error, self.softening * abs(one.x[0]))
        Y_error = math.hypot(one.Y_error, self.softening * one.Y)
        block = np.zeros((2 + 2 * one.n.size, point.size + 1))
        block[0, at["Y"]], block[0, -1] = 1.0 / Y_error, (point[at["Y"]] - one.Y) / Y_error
        block[1, at["psi"]], block[1, delay] = one.Y / Y_error, one.omega * one.Y / Y_error
        block[1, -1] = (point[at["psi"]] + one.omega * point[delay]) * one.Y / Y_error
        scaled = np.column_stack([by, x - one.x]) / error[:, None]
        block[2:] = np.vstack([scaled.real, scaled.imag])
        return block


@dataclass(frozen=True, eq=False)
class WaveformFit(OscillatorFit):
    """The oscillator whose waveforms fit the harmonics of n records best.

    unknowns : names and places of the p unknowns, and the harmonics of the records.
    residual : (model − data)/σ, (data,).
    response : derivatives of the point by the data in units of their errors, (p, data): dp = response · d(data)/σ; the
    data of a record are |Y|, its phase, Re x_n, Im x_n.
    places : places of each record's data.
    freedom : degrees of freedom.
    undamped : keys of the coefficients that are at zero.
    promise : what another step of the climb would gain in −log L, were the residuals linear.
    evaluations : evaluations that the search took.
    """

    unknowns: Unknowns
    residual: Array
    response: Array
    places: tuple[slice, ...]
    freedom: int
    undamped: tuple[str, ...]
    promise: float
    evaluations: int = 0

    @property
    def lines(self) -> tuple[Lines, ...]:
        """Harmonics of the records."""
        return self.unknowns.lines

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        return self.unknowns.law

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of the law's coefficients, then rho, m and delay."""
        return self.unknowns.names

    @property
    def F_k(self) -> float:
        """Friction force, N; the mean over the groups where it has some."""
        return float(self.unknowns.friction(self.point))

    @property
    def delay(self) -> float:
        """Time by which the response lags the base in the records in excess of the motion's phase, s."""
        return self.value("delay")

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom."""
        return self.chi_square / max(1, self.freedom)

    @property
    def adequate(self) -> bool:
        """Whether such an oscillator explains the records within their noise."""
        return not improbable(self.chi_square, self.freedom, self.lines)

    @property
    def converged(self) -> bool:
        """Whether the climb ended in an optimum: a step would move no unknown by a tenth of its standard error."""
        return self.promise < _GAIN_WHEN_CONVERGED

    @property
    def misfits(self) -> Array:
        """χ² of each record per datum, (n,)."""
        return np.array([np.mean(self.residual[place] ** 2) for place in self.places])

    @property
    def in_phase(self) -> Array:
        """Square of what the law leaves of the in-phase part of each kY/x_1, in its standard error, (n,): the stiffness
        against the amplitude."""
        squares = []
        for one, at, place in zip(self.lines, self.unknowns.at, self.places, strict=True):
            re, im = np.split(self.residual[place][2:], 2)
            x, base = one.x[0], self.point[at["Y"]] * np.exp(1j * self.point[at["psi"]])
            Z, law = one.Y / x, base / (x + one.x_error[0] * (re[0] + 1j * im[0]))
            error = abs(Z) * math.hypot(one.x_error[0] / abs(x), one.Y_error / one.Y)
            squares.append(((law - Z).real / error) ** 2)
        return np.array(squares)

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        return tuple(self.unknowns.response(self.point, i) for i in range(len(self.lines)))

    @property
    def slips(self) -> Mask:
        """Which records slip."""
        return np.array([response.slips for response in self.responses])

    @cached_property
    def waveforms(self) -> tuple[Waveform, ...]:
        """Waveform of each record, from which its features are read."""
        waveforms = []
        for i, response in enumerate(self.responses):
            of_record = (self.point, i, response)
            onset = self.unknowns.onset(*of_record)
            tail = self.unknowns.harmonics(*of_record, _HARMONICS_OF_WAVEFORM)
            at = self.unknowns.at[i]
            waveforms.append(
                Waveform(
                    response,
                    *onset,
                    *tail,
                    at=at,
                    F_k=float(self.point[at[FRICTION]]),
                    rho=self.rho,
                    rho_error=self.error("rho"),
                    Y=float(self.point[at["Y"]]),
                    by_data=self.response[:, self.places[i]],
                )
            )
        return tuple(waveforms)
