"""A number as it is printed: its digits, and with them how finely it was rounded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation

LONGEST = 25
"""Characters of a number at most."""

_POWERS = (-30, 30)  # of ten


@dataclass(frozen=True, slots=True)
class Printed:
    """A number as printed, e.g. "90.0402" or "2.9E-3"."""

    text: str

    @property
    def is_number(self) -> bool:
        """Whether the text is a number, of a size that a quantity of the paper can have, not a word as "degraded"."""
        try:
            highest = self.decimal.adjusted()
        except ValueError:
            return False
        if len(self.text) > LONGEST or not self.decimal.is_finite():
            return False
        return self.exponent >= _POWERS[0] and highest <= _POWERS[1]

    @property
    def decimal(self) -> Decimal:
        """The printed number, exactly. Raises ValueError when the text is not a number."""
        try:
            return Decimal(self.text)
        except InvalidOperation:
            text = f"printed value {self.text!r} is not a number such as 90.0402 or 2.9E-3"
            raise ValueError(text) from None

    @property
    def decimals(self) -> int:
        """Digits after the point: 4 of 0.0273, 4 of 2.9E-3."""
        return max(0, -self.exponent)

    @property
    def significant(self) -> int:
        """Significant digits: 3 of 0.0273, 2 of 2.9E-3."""
        return len(self.decimal.as_tuple().digits)

    @property
    def value(self) -> float:
        """The printed number as a float."""
        return float(self.decimal)

    @property
    def unit(self) -> float:
        """One unit of the last printed digit: 0.0001 for "90.0402"."""
        return float(Decimal(1).scaleb(self.exponent))

    @property
    def exponent(self) -> int:
        """Power of ten of the last printed digit: −4 for "90.0402"."""
        return int(self.decimal.as_tuple().exponent)

    def moved(self, units: int) -> str:
        """The text with its last digit moved by so many units, written alike: 90.0402 by 1 → 90.0403."""
        value = self.decimal + units * Decimal(1).scaleb(self.exponent)
        split = self.text.lower().find("e")
        if split < 0:
            return f"{value:.{self.decimals}f}"
        mantissa, power = Printed(self.text[:split]), self.text[split + 1 :]
        return f"{value.scaleb(-int(power)):.{mantissa.decimals}f}{self.text[split:]}"

    def show(self, value: float, extra: int = 4) -> str:
        """`value` written as the printed number is, with `extra` more digits, or with three decimals where a word is
        printed; "" for NaN."""
        if math.isnan(value):
            return ""
        if not self.is_number:
            return f"{value:.3f}"
        if "e" in self.text.lower():
            return f"{value:.{self.decimal.adjusted() - self.exponent + extra}e}"
        return f"{value:.{self.decimals + extra}f}"
