"""Maximum-likelihood fit of one oscillator to all records: the exact waveforms that fit their harmonics best.

The waveform of a record is the steady response of the oscillator (m, k, K_z, F_k) with a damping law, F_k and c by
default, under y = Y cos ωt and the further harmonics of the base that were measured. The stiffness k is given; the
coefficients of the law, ρ = K_z^{−1/2}, the mass m and the `nuisances` are common to all records, Y and the phase ψ of
the base are each record's own. Where the noise is white, harmonics taken by least squares over whole cycles hold all
the information on a steady motion, so that

    χ² = Σ |x_n(model) e^{inψ} − x_n|²/σ_n² + (Y(model) − Y)²/σ_Y² + (Yψ)²/σ_Y²

is that of the fit to all samples, whichever quantities were measured and however long the record is. Its minimum is the
estimate of largest likelihood; χ² itself says whether the records are those of such an oscillator. The waveform is
exact in every regime: one slip onset per half cycle, several, none. In ρ the rigid contact, ρ = 0, is a regular point.
Derivatives are differences of exact motions.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complexes, Integers, Mask
from ..law.law import Law
from ..law.terms import FRICTION
from ..model import BaseMotion, NoOscillator, Oscillator
from ..motion.law_steady import Further, Response, added_by_base, steady_response
from ..motion.orbit import NoSteadyOrbit
from ..signals.mean_harmonics import Waveform
from ..signals.record_harmonics import RecordHarmonics
from .climb import Climb
from .errors import inverse_information, welch_satterthwaite
from .fit import Fit, OscillatorFit
from .goodness import improbable
from .multistart import Trail
from .nuisances import FALLING, FOLDED, FORCES, NUISANCES, read_by_channels, units_of
from .parameters import Parameter, Parameters
from .score import Departure, departures_from
from .select import noise_of
from .starts import Shares, equivalent_coefficient

NO_MOTION = (ArithmeticError, NoOscillator, np.linalg.LinAlgError)
"""Errors of a point that has no motion to fit: no steady orbit, which is an ArithmeticError like a division by zero on
the way to one, a number out of range, or equations without a solution. Any other error is a defect, and shows."""

MOST_RADIANS_SEARCHED = 5e5
"""Radians of the fastest motion that are followed in search of one orbit: a quarter of a second of computing."""

# Of K_z/k: the contact that stands for a rigid one. It sticks for 10⁻⁵ rad of the cycle or so, by which friction comes
# late: that shows only where the noise is below 10⁻⁶ of the motion.
STIFFEST = 1e10
# Turns of the fastest motion, which cost as much as the rest of an evaluation.
TURNS_PER_EVALUATION = 200.0
_MOST_TURNS = 2e4  # of an orbit whose derivatives are computed: 0.1 s
_MOST_PHASES_FITTED = 64  # of half a cycle: to follow a contact that rattles on takes long
_SMALL = 1e-3  # of the drive: the force of a damper that counts as none
_LEAST = 1e-9  # of the friction that takes all work, and of the mass k/ω²: the least of both
_GAIN_WHEN_CONVERGED = 5e-3  # in −log L: half the square of a tenth of a standard error
# Odd harmonics of the waveform: beyond them lies less than 1e-6 of its velocity.
_HARMONICS_OF_WAVEFORM = 128
_REACH = math.log(5.0)  # of ln K_z to either side, where other minima are looked for
_MOST_STIFFNESS_STEPS = 64  # a few hundred evaluations: what a search may cost
_CLOSER = (1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0)  # of a step
INDEPENDENT = 4.0
"""Number of independent values in the residual of higher harmonics that no oscillator explains: it is similar at all
levels, and mostly in the third harmonic."""

SHARED = 0.007
"""Share of the residual of the higher harmonics that is an error of the fundamental, too, on which its cause acts."""

_SETTLED = 1.1  # ratio of two scales of errors that are the same
# Step of an unknown, for derivatives: orbits are exact to 1e-13, and curvature leaves a few times as much as the step,
# which is shorter by the number of swings in a stick, through which the motion turns with K_z.
_STEP = 1e-6
# Steps of a force from zero: to its equations, which are solved to 1e-11, from a closed form that is exact.
_STEP_OF_FORCES = 100.0


@dataclass(frozen=True, eq=False)
class HarmonicProblem:
    """Residuals (model − data)/σ of the harmonics of all records as functions of the unknowns: what is fitted.

    A point has the coefficients of the law, ρ = K_z^{−1/2}, the mass m and the nuisances, which are common to all
    records, or to a group of them; then Y and the phase ψ of the base of each record.

    law : of the damping.   lines : harmonics of the records.   k : stiffness, N/m, given.
    softening : part of the amplitudes added to the errors.   scales : factors of the errors of the fundamentals and of
    the higher harmonics.
    """

    law: Law
    lines: tuple[RecordHarmonics, ...]
    k: float
    softening: float = 0.0
    scales: tuple[float, float] = (1.0, 1.0)

    @cached_property
    def nuisances(self) -> tuple[str, ...]:
        """Names of the nuisances that the law does not have."""
        return tuple(name for name in NUISANCES if name not in self.law.terms)

    @cached_property
    def parameters(self) -> Parameters:
        """All unknowns, at rest under the drives that were read; the least ρ stands for a rigid contact. Free are those
        of the law, ρ and m, Y and ψ, and what folds where it makes a difference."""
        fastest = max(one.omega for one in self.lines)
        X, Y = np.array([(abs(one.x[0]), one.Y) for one in self.lines]).T
        units = units_of(self.k, fastest, float(X.max()), float(Y.max()))
        small = _SMALL * self.k * Y / np.array([one.omega for one in self.lines]) / X
        rows = []
        for key in self.law.keys:
            value, free = self.law.given.get(key, 0.0), key not in self.law.given
            low, scale = 0.0, float(max(small * self.equivalents(key.symbol)))
            if key.symbol == FRICTION:
                low, scale = _LEAST * float(max(self._rubbed)), 0.0
            own = key.group or ""
            rows.append(Parameter(key.symbol, value, low, free=free, scale=scale, group=own))
        rows += [
            Parameter("rho", 0.0, 1.0 / math.sqrt(STIFFEST * self.k), scale=0.0),
            Parameter("m", 0.0, _LEAST * self.k / fastest**2, scale=0.0),
        ]
        folds = any(one.folds is not None for one in self.lines)
        for name in self.nuisances:
            low, high = (units[name] * limit for limit in NUISANCES[name])
            free = folds and name == FOLDED
            rows.append(Parameter(name, 0.0, low, high, free, units[name]))
        for i, one in enumerate(self.lines, 1):
            rows.append(Parameter("Y", one.Y, 1e-3 * one.Y, scale=one.Y, group=str(i)))
            rows.append(Parameter("psi", 0.0, group=str(i)))
        return Parameters.of(rows)

    def start(self, candidate: Array) -> Parameters:
        """Return the unknowns of an oscillator (F_k, c, K_z, m) of `starts`: friction differs by the `shares` of the
        groups, and the work of c is shared out among the terms that are not given."""
        F_k, c, K_z, m = candidate.tolist()
        law = self.law
        values: dict[str, float] = {"rho": K_z**-0.5, "m": m}
        equivalents = {str(s): float(np.median(self.equivalents(s))) for s in law.terms}
        known = math.fsum(p / equivalents[s] for s, p in law.given.items() if s != FRICTION)
        free = [s for s in law.terms[1:] if s not in law.given]
        for i, part in enumerate(self.shares.friction.tolist()):
            values[law.key(FRICTION, i)] = F_k * part
            for s in free:
                values[law.key(s, i)] = max(c - known, 0.0) / len(free) * equivalents[s]
        return self.parameters.moved(**{**values, **law.given})

    def like(self, fit: Fit) -> Parameters:
        """Return the unknowns where another fit has them, under its drives and without its nuisances."""
        kept = {*self.parameters.keys} - {*self.nuisances} - {*self.law.given}
        return self.parameters.moved(**{s: fit.value(s) for s in kept if s in fit.parameters})

    @cached_property
    def shares(self) -> Shares:
        """Shares of F_k and c in each record: the friction of its group over the mean of all groups, if all work went
        into friction; the work of the terms that are not given, over the median of the records."""
        law, lines = self.law, self.lines
        labels = law.groups.get(FRICTION, ("",) * len(lines))
        means = {one: self._rubbed[[other == one for other in labels]].mean() for one in labels}
        force = np.array([means[label] for label in labels])
        equivalents = [self.equivalents(s) for s in law.terms[1:] if s not in law.given]
        damping = np.ones(len(lines))
        if equivalents:
            damping = np.mean([np.median(of) / of for of in equivalents], axis=0)
        return Shares(force / np.mean(list(means.values())), damping)

    @cached_property
    def _rubbed(self) -> Array:
        """Friction force of each record if all of its work went into friction, N, (n,)."""
        sines = [max(-one.x[0].imag / abs(one.x[0]), 1e-9) for one in self.lines]
        return np.array(
            [self.k * one.Y * sine for one, sine in zip(self.lines, sines, strict=True)]
        )

    @property
    def samples(self) -> int:
        """Number of data: |Y|, its phase, and the harmonics of each record."""
        return self.places[-1].stop

    @cached_property
    def places(self) -> tuple[slice, ...]:
        """Places of each record's data: |Y|, its phase, Re x_n, Im x_n."""
        ends = np.cumsum([0, *(2 + 2 * one.n.size for one in self.lines)]).tolist()
        return tuple(itertools.starmap(slice, itertools.pairwise(ends)))

    def thinned(self) -> HarmonicProblem:
        """Return the problem itself: harmonics are few."""
        return self

    @cached_property
    def fundamentals(self) -> Mask:
        """Which of the data are |Y|, its phase, Re x_1, Im x_1, (data,); the others are the higher harmonics."""
        of = [np.concatenate([[True, True], one.n == 1, one.n == 1]) for one in self.lines]
        return np.concatenate(of)

    def softened(self, part: float) -> HarmonicProblem:
        """Return the problem with a part of the amplitudes added to the errors."""
        return replace(self, softening=part)

    @cached_property
    def at(self) -> list[dict[str, int]]:
        """Places of the unknowns of each record: those of its law by symbol, rho, m, the nuisances, Y and psi."""
        places, shared = self.parameters.places, ("rho", "m", *self.nuisances)
        return [
            {s: places[self.law.key(s, i)] for s in self.law.terms}
            | {name: places[name] for name in shared}
            | {name: places[f"{name}[{i + 1}]"] for name in ("Y", "psi")}
            for i in range(len(self.lines))
        ]

    def equivalents(self, symbol: str) -> Array:
        """Return the `equivalent_coefficient` of a term in each record, (n,)."""
        return np.array([equivalent_coefficient(symbol, one, self.k) for one in self.lines])

    @cached_property
    def _levels(self) -> Array:
        """ln Y/Ȳ of each record, (n,)."""
        sizes = np.log([one.Y for one in self.lines])
        return np.asarray(sizes - sizes.mean())

    @cached_property
    def _fastest(self) -> float:
        """The largest speed of all records, by their fundamentals, m/s."""
        return max(one.omega * float(abs(one.x[0])) for one in self.lines)

    def response(self, point: Array, record: int, near: Response | None = None) -> Response:
        """Return the motion of a record under the fundamental of its base.   near : a motion from which to start.

        Raises NO_MOTION.
        """
        value = {name: float(point[at]) for name, at in self.at[record].items()}
        law: dict[str, float] = {s: value[s] for s in self.law.terms if s not in (FRICTION, "c")}
        F_k = value[FRICTION] * (1.0 + value["friction_level"] * float(self._levels[record]))
        # ρ is that of the stiffness after a reversal, which is larger by the gradual part (`rounding`)
        K_z = value["rho"] ** -2 / (1.0 + value["gradual"])
        oscillator = Oscillator(value["m"], value.get("c", 0.0), self.k, K_z, F_k)
        if value["c_2"]:
            law["c_2"] = value["c_2"]
        falling = value["friction_speed"], FALLING * self._fastest
        further = Further(value["k_3"], value["gradual"], *(falling if falling[0] else ()))
        return steady_response(
            oscillator,
            BaseMotion(value["Y"], self.lines[record].omega),
            law,
            near,
            further=further,
            most_radians=MOST_RADIANS_SEARCHED,
        )

    def harmonics(
        self,
        point: Array,
        record: int,
        response: Response,
        count: int,
        added: Complexes | None = None,
    ) -> Complexes:
        """Return harmonics n = 1, 3 … of a record as it reads them, m, (count,), from its motion: with what the
        harmonics of the base and the nuisances add, turned by ψ.

        added : what the harmonics of the base add, where that is known.
        """
        if added is None:
            base = self.lines[record].base / (1.0 + point[self.at[record]["gain"]])
            added = added_by_base(base, response, count)
        n = np.arange(1, 2 * count, 2)
        return self._read(point, record, n, response.harmonics(count) + added)

    def folded(self, point: Array, record: int, response: Response) -> Complexes:
        """Return what harmonics beyond half the sampling rate add to those of a record, m, (h,), from its motion."""
        one, part = self.lines[record], point[self.at[record][FOLDED]]
        if one.folds is None or not part:
            return np.zeros(one.n.size, dtype=np.complex128)
        n = one.folds.orders
        return part * one.folds.of(self._read(point, record, n, response.high_harmonics(n)))

    def _read(self, point: Array, record: int, n: Integers, x: Complexes) -> Complexes:
        """Return harmonics x_n, m, of a motion as a record reads them."""
        at = self.at[record]
        value = {name: float(point[at[name]]) for name in self.nuisances}
        if any(value.values()):
            x = read_by_channels(x, float(point[at["Y"]]), n, self.lines[record], value)
        return np.asarray(x * np.exp(1j * n * point[at["psi"]]))

    def slopes(
        self,
        point: Array,
        free: Mask,
        record: int,
        response: Response,
        read: Callable[[Array, Response], NDArray[Any]],
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return what is read off a record at a point, (any,), and its derivatives by the unknowns that are free, ψ
        apart, (any, size), by differences.

        response : the record's motion there.   read : of a point and the motion.   Raises NO_MOTION.
        """
        here = read(point, response)
        slopes = np.zeros((here.size, point.size), dtype=here.dtype)
        steps = _STEP / (1.0 + response.swings) * np.maximum(np.abs(point), self.parameters.scale)
        for name, j in self.at[record].items():
            if not free[j] or name == "psi":
                continue
            beside = point.copy()
            # of a force that the law does not have, several slips leave unknown what it does
            untested = name in FORCES and name in self.nuisances and not point[j]
            beside[j] += _STEP_OF_FORCES * steps[j] if untested else steps[j]
            try:
                there = read(beside, self.response(beside, record, response))
            except NoSteadyOrbit:
                if untested:
                    continue
                raise
            slopes[:, j] = (there - here) / (beside[j] - point[j])
        return here, slopes

    def scan(self, parameters: Parameters) -> Array:
        """Return values of ρ at which to look for other minima of χ², to a fifth and to five times the K_z of a point.

        A contact that sticks for N swings rings in step with the records at every K_z that changes N by one,
        Δ ln K_z = 2/N: four steps lead from one of them to the next. Near the point kinks of χ² lie close together.
        """
        swings = max(self.response(parameters.values, i).swings for i in range(len(self.lines)))
        step = max(0.5 / max(swings, 1.0), 2.0 * _REACH / _MOST_STIFFNESS_STEPS)
        away = np.array([*_CLOSER, *range(1, 1 + int(_REACH / step))]) * step
        values: Array = parameters["rho"].value * np.exp(0.5 * np.append(away, -away))
        return values

    def products(self, values: Array, free: Mask, trail: Trail, out: Array) -> bool:
        """Set `out` to the products of derivatives and residuals, as `climb` takes them."""
        whole = self.evaluate(values, free, trail)
        if whole is not None:
            np.matmul(whole.T, whole, out=out)
        return whole is not None

    def evaluate(self, values: Array, free: Mask, trail: Trail) -> Array | None:
        """Return derivatives of the residuals by the unknowns that are free and, in the last column, the residuals
        themselves, (n, p + 1); None where nothing slips, there is no orbit, the contact rattles, or no evaluation is
        left: a light mass that swings on while it sticks takes as long as many others."""
        if trail.left <= 0.0:
            return None
        try:
            blocks = [self._block(values, free, i, trail) for i in range(len(self.lines))]
        except NO_MOTION:
            return None
        slips = any(trail.near[i].slips for i in range(len(self.lines)))
        return np.vstack(blocks) if slips else None

    def _follow(self, point: Array, i: int, trail: Trail) -> Response:
        """Return the motion of a record.   Raises NO_MOTION, perhaps after a long search."""
        share = 1.0 / len(self.lines)
        try:
            response = self.response(point, i, trail.near.get(i))
        except NoSteadyOrbit:
            trail.left -= share * MOST_RADIANS_SEARCHED / (2.0 * math.pi * TURNS_PER_EVALUATION)
            raise
        trail.near[i] = response
        par = response.orbit.parameters
        # or the decay of a velocity by e^{2π} where a light mass creeps in a strong damper
        turns = max(response.swings, 0.5 * par.c / par.m / par.omega)
        if len(response.orbit.phases) > _MOST_PHASES_FITTED or turns > _MOST_TURNS:
            raise NoSteadyOrbit("the contact rattles")
        trail.left -= share * (1.0 + turns / TURNS_PER_EVALUATION)
        return response

    def _block(self, point: Array, free: Mask, i: int, trail: Trail) -> Array:
        """Return the rows of a record: |Y|, its phase, Re x_n, Im x_n.   Raises NO_MOTION."""
        near = self._follow(point, i, trail)
        one, at, count = self.lines[i], self.at[i], self.lines[i].n.size
        # slopes leave out how the harmonics of the base, which are small, act otherwise beside a point
        added = added_by_base(one.base / (1.0 + point[at["gain"]]), near, count)

        def read(at: Array, response: Response) -> Complexes:
            folded = self.folded(at, i, response)
            return self.harmonics(at, i, response, count, added) + folded

        x, by = self.slopes(point, free, i, near, read)
        by[:, at["psi"]] = 1j * one.n * x
        scaled = one.x_error * np.where(one.n == 1, *self.scales)
        error = np.hypot(scaled, self.softening * abs(one.x[0]))
        Y_error = math.hypot(self.scales[0] * one.Y_error, self.softening * one.Y)
        gain, Y = 1.0 + point[at["gain"]], point[at["Y"]]
        block = np.zeros((2 + 2 * count, point.size + 1))
        block[0, at["Y"]] = gain / Y_error
        block[0, at["gain"]] = Y / Y_error * free[at["gain"]]
        block[0, -1] = (gain * Y - one.Y) / Y_error
        block[1, at["psi"]] = one.Y / Y_error
        block[1, -1] = point[at["psi"]] * one.Y / Y_error
        if one.of_base:  # with the base as it was read, not as it moves
            turned = one.of_base * np.exp(1j * point[at["psi"]])
            x[0] -= gain * Y * turned - one.of_base * one.Y
            by[0, at["Y"]] -= gain * turned
            by[0, at["psi"]] -= 1j * gain * Y * turned
            by[0, at["gain"]] -= Y * turned * free[at["gain"]]
        of_x = np.column_stack([by, x - one.x]) / error[:, None]
        block[2:] = np.vstack([of_x.real, of_x.imag])
        return block

    def explains(self, end: Climb | Fit) -> bool:
        """Return whether such an oscillator explains the records within their noise."""
        freedom = self.samples - int(np.count_nonzero(end.parameters.free))
        return not improbable(end.chi_square, freedom, self.lines)

    def fit(self, end: Climb) -> WaveformFit | None:
        """Return the fit at the end of a climb; None where its motions are not found again from nothing."""
        fit = WaveformFit(
            parameters=end.parameters,
            covariance=inverse_information(end.products[:-1, :-1], end.parameters.prior),
            chi_square=end.chi_square,
            freedom=self.samples - int(np.count_nonzero(end.parameters.free)),
            problem=self,
            evaluations=end.evaluations,
            promise=end.promise,
        )
        try:
            return fit if fit.responses else None
        except NO_MOTION:
            return None


class WaveformFit(OscillatorFit):
    """The oscillator whose waveforms fit the harmonics of n records best."""

    problem: HarmonicProblem

    @property
    def lines(self) -> tuple[RecordHarmonics, ...]:
        """Harmonics of the records."""
        return self.problem.lines

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        return self.problem.law

    @property
    def F_k(self) -> float:
        """Friction force, N; the mean over the groups where it has some."""
        return float(np.mean([self.value(key) for key in self.law.keys_of(FRICTION)]))

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        return tuple(self.problem.response(self.point, i) for i in range(len(self.lines)))

    def _evaluated(self, *freed: str) -> Array | None:
        """Return what the problem gives at the fit with further unknowns free, see `HarmonicProblem.evaluate`."""
        trail = Trail()
        trail.near.update(enumerate(self.responses))
        return self.problem.evaluate(self.point, self.parameters.freed(*freed).free, trail)

    @cached_property
    def _here(self) -> Array:
        """Derivatives of the residuals and, in the last column, the residuals, (data, p + 1)."""
        here = self._evaluated()
        assert here is not None  # the climb was there
        return here

    @property
    def residual(self) -> Array:
        """(model − data)/σ, (data,)."""
        return self._here[:, -1]

    @cached_property
    def response(self) -> Array:
        """Derivatives of the point by the data in units of their errors, (p, data): dp = response · d(data)/σ; the data
        of a record are |Y|, its phase, Re x_n, Im x_n."""
        return np.asarray(self.covariance @ self._here[:, :-1].T)

    def _parts(self, key: str) -> Array:
        """Return what the fundamentals and the harmonics of each record contribute to the variance of a parameter, and
        the degrees of freedom with which that is known, (2, parts): the errors of the data come from the scatter of few
        rows, that of a fundamental, which is the data's most, from 2(rows − 1) numbers; where a group leaves more than
        noise, those of all records from what it leaves."""
        squares, main = self.response[self.parameters.places[key]] ** 2, self.problem.fundamentals
        of_main, of_others = self.problem.scales
        left = self.freedoms[0] if of_main > 1.0 + SHARED * of_others else INDEPENDENT
        parts = []
        for group, scale, freedom in ((main, of_main, left), (~main, of_others, INDEPENDENT)):
            own = np.where(group, squares, 0.0)
            if scale > 1.0:
                parts.append((float(np.sum(own)), max(freedom, 1.0)))
                continue
            for one, place in zip(self.lines, self.problem.places, strict=True):
                known = 2 * max(1, one.rows - 1) if group is main else one.error_freedom
                parts.append((float(np.sum(own[place])), known))
        return np.transpose(parts)

    def freedom_of(self, key: str) -> float:
        """Return the degrees of freedom of the error of a parameter."""
        return welch_satterthwaite(*self._parts(key))

    def reach(self, key: str) -> float:
        """Return half the width of the 95 % interval of a parameter, in its unit. Weights from the scatter of few rows
        increase its variance by the share 4 Σ p_i(1 − p_i)/f_i, p_i the shares of its parts (Meier, Biometrics 9,
        1953)."""
        v, f = self._parts(key)
        p = v / (float(np.sum(v)) or 1.0)
        return math.sqrt(1.0 + 4.0 * float(np.sum(p * (1.0 - p) / f))) * super().reach(key)

    @cached_property
    def freedoms(self) -> tuple[float, float]:
        """Degrees of freedom of what the fundamentals and the higher harmonics leave: their number, less what they have
        of the unknowns."""
        used = np.sum(self._here[:, :-1].T * self.response, axis=0)
        main = self.problem.fundamentals
        return float(np.sum(1.0 - used[main])), float(np.sum(1.0 - used[~main]))

    @property
    def scales(self) -> tuple[float, float]:
        """Factors of the errors of the fundamentals and of the higher harmonics by what they leave beyond noise."""
        main, (a, b) = self.problem.fundamentals, self.problem.scales
        left = [float(np.sum((self.residual[of] * by) ** 2)) for of, by in ((main, a), (~main, b))]
        of_main, of_others = self.freedoms
        harmonics = noise_of(left[1], of_others, INDEPENDENT)
        shared = SHARED**2 * (harmonics - 1.0)
        return math.sqrt(noise_of(left[0], of_main) + shared), math.sqrt(harmonics)

    @property
    def adequate(self) -> bool:
        """Whether such an oscillator explains the records within their noise, as it was read or scaled."""
        scales = self.problem.scales
        if max(scales) == 1.0:
            return self.problem.explains(self)
        return all(left < _SETTLED * of for left, of in zip(self.scales, scales, strict=True))

    @property
    def holds(self) -> bool:
        """Whether it does so with the errors that were read."""
        return self.adequate and max(self.problem.scales) == 1.0

    @property
    def converged(self) -> bool:
        """Whether the climb ended in an optimum: a step would move no unknown by a tenth of its standard error."""
        return self.promise < _GAIN_WHEN_CONVERGED

    @property
    def misfits(self) -> Array:
        """χ² of each record per datum, (n,)."""
        return np.array([np.mean(self.residual[place] ** 2) for place in self.problem.places])

    @cached_property
    def departures(self) -> dict[str, Departure]:
        """Test what each nuisance that is not fitted would explain, by name, to first order; those that the data do not
        show left out."""
        whole = self._evaluated(*self.problem.nuisances)
        if whole is None:  # the motion rattles, or nothing slips
            return {}
        free, places = self.parameters.free, self.parameters.places
        others = [s for s in self.problem.nuisances if not free[places[s]] and s != FOLDED]
        tested = departures_from(
            self.residual,
            whole[:, :-1][:, free],
            {name: whole[:, places[name]] for name in others},
            [one.key for one in self.parameters if one.free and one.name not in ("Y", "psi")],
            noise_known=True,
        )
        return {one.symbol: one for one in tested}

    @cached_property
    def waveforms(self) -> tuple[Waveform, ...]:
        """Waveform of each record, from which its features are read."""
        problem, free, waveforms = self.problem, self.parameters.free, []

        def onset(point: Array, response: Response) -> Array:
            return np.array([response.V_s, response.t_s, response.stick_travel])

        main, pairs = problem.fundamentals, zip(self.responses, problem.at, strict=True)
        for (i, (response, at)), place in zip(enumerate(pairs), problem.places, strict=True):

            def tail(point: Array, response: Response, i: int = i) -> Complexes:
                return problem.harmonics(point, i, response, _HARMONICS_OF_WAVEFORM)

            x, by = problem.slopes(self.point, free, i, response, tail)
            by[:, at["psi"]] = 1j * np.arange(1, 2 * x.size, 2) * x
            waveforms.append(
                Waveform(
                    response,
                    *problem.slopes(self.point, free, i, response, onset),
                    *(x, by),
                    at=at,
                    F_k=float(self.point[at[FRICTION]]),
                    rho=response.orbit.parameters.K_z**-0.5 * (not self.rigid),
                    rho_error=self.error("rho"),
                    folded=problem.folded(self.point, i, response),
                    by_data=self.response[:, place] / np.where(main[place], *problem.scales),
                )
            )
        return tuple(waveforms)
