"""Reference fit: maximum likelihood of (F_k, c, K_z) against the exact steady orbit, the yardstick for every approach.

Records of steady responses at one or more levels, channels y, x[, ẋ, ẍ] with white Gaussian noise. With known standard
deviations σ the likelihood is largest where Σ r²/σ² is smallest, r = measured − model. With unknown ones, one for each
channel of each record, they are profiled out: σ² = Σ r²/n, and the fit minimises Σ ½ n log Σ r². Its gradient is that
of weighted least squares with those σ, so that both are solved by Levenberg–Marquardt steps on

    I δ = Σ J r / σ²,   I = Σ J Jᵀ / σ²  (the Fisher information of `information.py`),

the weights following r. Unknown besides (F_k, c, ρ = K_z^{−1/2}) are Y, ψ and the channel offsets of each record, and
on request the mass and the frequencies. All samples enter, at their own times; nothing is folded or interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..model import BaseMotion, Oscillator, finite_number
from ..motion.orbit import NoSteadyOrbit
from ..reading.climb import Climb, Evaluation, NoStart, climb
from ..record import Record
from .derivatives import clean_signals, compliance_root, response, smallest_compliance_root
from .information import (
    Noise,
    Terms,
    assemble,
    channel_terms,
    covariance_of_K_z,
    deviation,
    inverse,
    require_known,
)
from .residuals import Residual, adequacy
from .result import ReferenceFit, warnings_of
from .start import Lines, lines_of, refuse_linear, starting_point

_COARSE = 2048  # samples of a record that a first fit looks at: it brings the start within a few standard errors
_FLOOR = 1e-9  # of the rms of a channel: the least noise that is assumed; below it stands rounding (of ωt, above all)


def reference_fit(
    records: Sequence[Record],
    omega: float | Sequence[float],
    m: float,
    k: float,
    *,
    start: Oscillator | None = None,
    noise: Noise | None = None,
    free: Collection[str] = (),
) -> ReferenceFit:
    """F_k, c and K_z of largest likelihood given steady records.

    omega : rad/s, one for all records or one per record.   m : kg.   k : N/m.
    start : its F_k, c, K_z (and m, if free) are where to begin; default: an energy balance of the harmonics.
    noise : standard deviation of every channel, one for all records or one per record; default: estimated.
    free : "m" and "omega" are fitted, too; the numbers given are then where they begin.

    Raises NotIdentifiable where nothing slips, NoConvergence, NoSteadyOrbit; ValueError for what makes no sense.
    """
    _check(records, m, k, noise, free)
    omegas = _frequencies(omega, len(records))
    tau = [record.t - record.t.mean() for record in records]
    problem = _Problem(records, tau, omegas, m, k, noise, free)
    lines = lines_of(records, tau, omegas)
    refuse_linear(lines, omegas, m, k)
    osc = starting_point(lines, omegas, m, k) if start is None else start
    point, (lower, scale) = problem.point(osc, lines), problem.limits(lines)
    try:
        for part in (problem.thinned(), problem):
            if part is not None:
                climbed = climb(part.evaluate, point, lower, scale)
                point = climbed.point
    except NoStart:
        raise ValueError(
            "nothing slips in any record with the F_k, c and K_z of the start, or it has no steady orbit; start with a "
            "smaller F_k, or leave the start to the fit"
        ) from None
    return problem.report(climbed)


def _check(
    records: Sequence[Record], m: float, k: float, noise: Noise | None, free: Collection[str]
) -> None:
    """ValueError for what makes no sense."""
    if not records:
        raise ValueError("a fit needs at least one record")
    require_known(noise or {}, free)
    for name, value in (("m", m), ("k", k)):
        if not finite_number(name, value) > 0.0:
            raise ValueError(f"{name} must be positive, got {value!r}")
    for i, record in enumerate(records):
        missing = sorted(_channels(record).keys() - noise.keys()) if noise is not None else []
        if missing:
            raise ValueError(f"noise lacks the channels {missing} of record {i + 1}")


def _frequencies(omega: float | Sequence[float], records: int) -> list[float]:
    """ω of each record."""
    given = np.atleast_1d(np.asarray(omega, dtype=float))
    omegas = np.repeat(given, records if given.size == 1 else 1).tolist()
    if len(omegas) != records or not all(math.isfinite(w) and w > 0.0 for w in omegas):
        raise ValueError(
            f"omega must be one positive number, or one per record, got {omega!r} for {records} records"
        )
    return omegas


@dataclass(frozen=True, eq=False)
class _Problem:
    """Records with what was given about them. A point holds F_k, c, ρ[, m], then Y, ψ[, ω] of each record."""

    records: Sequence[Record]
    tau: list[Array]
    omega: list[float]
    m: float
    k: float
    noise: Noise | None
    free: Collection[str]

    @property
    def common(self) -> int:
        """Number of unknowns common to all records."""
        return 3 + ("m" in self.free)

    @property
    def own(self) -> int:
        """Number of unknowns of each record, offsets apart."""
        return 2 + ("omega" in self.free)

    def thinned(self) -> _Problem | None:
        """This problem with about `_COARSE` samples of each record, or None where they have not many more."""
        strides = [max(len(record) // _COARSE, 1) for record in self.records]
        if max(strides) < 2:
            return None
        records = [
            Record(**{name: signal[::stride] for name, signal in record.signals().items()})
            for record, stride in zip(self.records, strides, strict=True)
        ]
        tau = [times[::stride] for times, stride in zip(self.tau, strides, strict=True)]
        return replace(self, records=records, tau=tau)

    def point(self, osc: Oscillator, lines: Lines) -> Array:
        """The point of an oscillator, with Y and ψ of the records' own harmonics."""
        own = np.column_stack([lines.Y, lines.psi, self.omega])[:, : self.own]
        common = [osc.F_k, osc.c, compliance_root(osc.K_z), osc.m][: self.common]
        return np.concatenate([common, np.ravel(own)])

    def limits(self, lines: Lines) -> tuple[Array, Array]:
        """The least value of each unknown, and one that is as good as zero.

        F_k stays just above zero, where it would take K_z along.
        """
        force = self.k * float(lines.Y.max())
        rigid = smallest_compliance_root(self.k)
        common = [
            (1e-9 * force, 1e-9 * force),
            (0.0, 1e-6 * math.sqrt(self.k * self.m)),
            (rigid, rigid),
            (1e-6 * self.m, 1e-6 * self.m),
        ][: self.common]
        own = [
            ((1e-3 * Y, 1e-3 * Y), (-math.inf, 1.0), (0.9 * w, w))[: self.own]
            for Y, w in zip(lines.Y, self.omega, strict=True)
        ]
        lower, scale = np.array([*common, *(pair for pairs in own for pair in pairs)]).T
        return lower, scale

    def model(self, point: Array, i: int) -> tuple[Oscillator, BaseMotion, float]:
        """Oscillator, motion of the base and ψ of record i."""
        F_k, c, rho = point[:3].tolist()
        m = float(point[3]) if "m" in self.free else self.m
        Y, psi, *omega = point[self.common :].reshape(len(self.records), -1)[i].tolist()
        motion = BaseMotion(Y, omega[0] if omega else self.omega[i])
        return Oscillator(m, c, self.k, rho**-2, F_k), motion, psi

    def evaluate(self, point: Array) -> Evaluation | None:
        """−log L up to a constant, and the normal equations; None where nothing slips or an orbit is missing."""
        terms: list[dict[str, Terms]] = []
        weights: list[dict[str, float]] = []
        value, slips = 0.0, False
        for i, (record, tau) in enumerate(zip(self.records, self.tau, strict=True)):
            osc, motion, psi = self.model(point, i)
            channels = _channels(record)
            try:
                model = response(osc, motion, psi, tau, list(channels), self.free)
            except NoSteadyOrbit:
                return None
            slips |= math.isfinite(model.orbit.X_s)
            terms.append(
                {
                    name: channel_terms(model.jacobian[name], signal - model.values[name])
                    for name, signal in channels.items()
                }
            )
            weights.append({})
            for name, sums in terms[-1].items():
                if self.noise is None:
                    least = max((_FLOOR * float(np.std(channels[name]))) ** 2 * sums.n, 1e-300)
                    rss = max(sums.rss, least)
                    weights[-1][name] = sums.n / rss
                    value += 0.5 * sums.n * (math.log(rss) + min(sums.rss / least, 1.0))
                else:
                    weights[-1][name] = deviation(self.noise, name, i, len(self.records)) ** -2
                    value += 0.5 * weights[-1][name] * sums.rss
        return Evaluation(value, *assemble(terms, weights, self.common)) if slips else None

    def report(self, climbed: Climb[Evaluation]) -> ReferenceFit:
        """The estimate where a climb ended, with its uncertainty, the residuals' verdict and warnings."""
        point, (_, undamped, rigid) = climbed.point, climbed.active[:3].tolist()
        osc = self.model(point, 0)[0]
        covariance = inverse(climbed.evaluation.information)
        of_K_z = covariance_of_K_z(covariance, osc.K_z)
        if rigid:
            of_K_z[2, :] = of_K_z[:, 2] = math.nan
            of_K_z[2, 2] = math.inf
        Y, psi, omega = self.bases(point)
        residuals, silent = self.residuals(point)
        noise = self.noise_of(residuals, point.size)
        every = [r for channels in residuals for r in channels.values()]
        samples = sum(r.values.size - 1 for r in every)
        sigmas = [sigma for channels in noise for sigma in channels.values()]
        chi_square = math.nan
        if self.noise is not None:
            chi_square = sum(_square(r) / s**2 for r, s in zip(every, sigmas, strict=True))
        fit = ReferenceFit(
            F_k=osc.F_k,
            c=osc.c,
            K_z=math.inf if rigid else osc.K_z,
            covariance=of_K_z,
            rho=0.0 if rigid else compliance_root(osc.K_z),
            rho_standard_error=math.sqrt(covariance[2, 2]),
            m=osc.m,
            m_standard_error=math.sqrt(covariance[3, 3]) if "m" in self.free else 0.0,
            Y=Y,
            psi=psi,
            omega=omega,
            noise=_by_channel(noise),
            offsets=_by_channel(
                [{name: float(r.values.mean()) for name, r in rs.items()} for rs in residuals]
            ),
            chi_square=chi_square / (samples - point.size),
            adequacy=adequacy(every, point.size - len(self.records) * ("omega" in self.free)),
            iterations=climbed.iterations,
            warnings=(),
        )
        return replace(fit, warnings=tuple(warnings_of(fit, silent, undamped, samples)))

    def bases(self, point: Array) -> tuple[Array, Array, Array]:
        """Y (m), ψ (rad, of the records' own times) and ω (rad/s) of each record."""
        own = point[self.common :].reshape(len(self.records), -1)
        omega = own[:, 2] if "omega" in self.free else np.array(self.omega)
        middles = np.array([record.t.mean() for record in self.records])
        psi = np.mod(own[:, 1] - omega * middles + math.pi, 2.0 * math.pi) - math.pi
        return own[:, 0].copy(), psi, omega

    def residuals(self, point: Array) -> tuple[list[dict[str, Residual]], list[int]]:
        """What the model leaves of each record, by channel; and the numbers of the records in which nothing slips."""
        residuals, silent = [], []
        for i, (record, tau) in enumerate(zip(self.records, self.tau, strict=True)):
            osc, motion, psi = self.model(point, i)
            signals, phase = _channels(record), motion.omega * tau
            orbit, values = clean_signals(osc, motion, psi, tau, list(signals))
            if not math.isfinite(orbit.X_s):
                silent.append(i + 1)
            residuals.append(
                {name: Residual(u - values[name], u, phase) for name, u in signals.items()}
            )
        return residuals, silent

    def noise_of(
        self, residuals: Sequence[Mapping[str, Residual]], unknowns: int
    ) -> list[dict[str, float]]:
        """Standard deviation of each channel of each record, as given or as estimated.

        Each channel pays its share of the degrees of freedom.
        """
        share = unknowns / sum(map(len, residuals))
        return [
            {
                name: math.sqrt(_square(r) / max(r.values.size - 1 - share, 1.0))
                if self.noise is None
                else deviation(self.noise, name, i, len(residuals))
                for name, r in channels.items()
            }
            for i, channels in enumerate(residuals)
        ]


def _square(residual: Residual) -> float:
    """Sum of squares about the offset."""
    return float(np.sum((residual.values - residual.values.mean()) ** 2))


def _by_channel(records: Sequence[Mapping[str, float]]) -> dict[str, Array]:
    """A number of each record, by the channels of the records that have them."""
    names = dict.fromkeys(name for record in records for name in record)
    return {name: np.array([r[name] for r in records if name in r]) for name in names}


def _channels(record: Record) -> dict[str, Array]:
    return {name: signal for name, signal in record.signals().items() if name != "t"}
