"""What a reference fit hands over: the estimate, its uncertainty, and warnings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..arrays import Array
from .information import Coefficients
from .residuals import Adequacy

_NORMAL_95 = 1.959963984540054  # 97.5 % point of the normal distribution
_NORMAL_999 = 3.29  # 99.95 % point
_LEVEL = 1e-3  # of the probability below which a test rejects


@dataclass(frozen=True, eq=False)
class ReferenceFit(Coefficients):
    """Maximum-likelihood estimate from n records; SI units.

    F_k : N.   c : N s/m.   K_z : N/m; infinite where the best contact is rigid.
    covariance : (3, 3), of (F_k, c, K_z), the inverse Fisher information at the estimate. Where K_z is infinite its row
    and column are infinite and NaN.   rho, rho_standard_error : K_z^{−1/2}, whose distribution is closer to normal.
    m, m_standard_error : kg; 0 where the mass was given.
    Y (m), psi (rad), omega (rad/s) : y = Y cos(ωt + ψ), t the record's own time, (n,).
    noise, offsets : standard deviation (given, or estimated) and offset of each channel, (n,).
    chi_square : Σ r²/σ² per degree of freedom where the noise was given, else NaN (it is 1 by construction).
    adequacy : whether the residuals are white.   iterations : on all samples.   warnings : to the reader.
    """

    rho: float
    rho_standard_error: float
    m: float
    Y: Array
    psi: Array
    omega: Array
    noise: dict[str, Array]
    offsets: dict[str, Array]
    chi_square: float
    adequacy: Adequacy
    iterations: int
    warnings: tuple[str, ...]

    @property
    def K_z_interval(self) -> tuple[float, float]:
        """95 % interval of K_z, N/m, from ρ ± 1.96 standard errors; unbounded above where ρ = 0 is within."""
        spread = _NORMAL_95 * self.rho_standard_error
        low, high = self.rho - spread, self.rho + spread
        return high**-2, (low**-2 if low > 0.0 else math.inf)


def warnings_of(
    fit: ReferenceFit, silent: Sequence[int], undamped: bool, samples: int
) -> Iterator[str]:
    """Warnings to the reader of the fit.

    silent : numbers of the records in which nothing slips.   undamped : whether c is at its limit.
    samples : that χ² is the mean of.
    """
    low, high = fit.K_z_interval
    if math.isinf(high):
        yield (
            f"the records do not tell the contact from a rigid one: K_z is above {low:.3g} N/m (97.5 %), without an "
            "upper limit; sample faster, measure acceleration, or reduce the noise"
        )
    if undamped:
        yield "the best c is at its limit, zero: its standard error is not that of a normal distribution"
    if silent:
        yield f"nothing slips in record {', '.join(map(str, silent))}: it says nothing of F_k"
    if abs(fit.chi_square - 1.0) > _NORMAL_999 * math.sqrt(2.0 / samples):  # NaN: not tested
        yield (
            f"the residuals are {math.sqrt(fit.chi_square):.4g} times the noise given: the noise or the model is "
            "wrong; do not trust the intervals"
        )
    if fit.adequacy.harmonics_p < _LEVEL:
        yield (
            f"the residuals repeat with the drive (χ² = {fit.adequacy.harmonics:.3g} per degree of freedom at its "
            "harmonics, 1 expected): the oscillator is not of this kind, or k or m is wrong; do not trust the intervals"
        )
    if fit.adequacy.whiteness_p < _LEVEL:
        yield (
            f"the residuals are not white (Ljung–Box χ² = {fit.adequacy.whiteness:.3g} per degree of freedom, 1 "
            "expected): the frequency is wrong, the response not steady or the noise filtered; do not trust the "
            "intervals"
        )
