"""A number as it is printed: one place decides on digits, powers of ten, signs and spaces.

Numbers are rounded in decimal arithmetic from the text of the result file, so that the digits printed are those of the
file and not of a binary neighbour.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from decimal import ROUND_CEILING, ROUND_HALF_EVEN, Decimal, InvalidOperation
from typing import Any, Literal

from ...project.wording import MINUS, NONE, in_words, scientific, ten_to

Form = Literal["text", "verbatim", "plain", "fixed", "significant", "power", "bound", "word"]

THIN = "\u2009"
_PLAIN_DIGITS = 7  # significant digits of a parameter: more than any configuration states


@dataclass(frozen=True, slots=True)
class Style:
    """How a raw value becomes text.

    form : text         as it stands
           verbatim     the digits as they stand, with a typographic minus and power of ten
           plain        the shortest form of a parameter, thousands apart
           fixed        so many decimals            significant   so many significant digits, without a power of ten
           power        so many decimals and a power of ten         bound   the power of ten that it stays below
           word         a small count in words
    digits : for the forms that need it.   scale : a power of ten, as text, to multiply by first.
    signed : a plus sign for positive numbers, too.   unsigned : the size of the number.
    """

    form: Form
    digits: int = 0
    scale: str = "1"
    signed: bool = False
    unsigned: bool = False

    def as_json(self) -> dict[str, Any]:
        """For the record beside the value."""
        return asdict(self)

    def render(self, raw: object) -> str:
        """The printed text; "–" where there is no value. Raises ValueError for text where a number is needed."""
        if self.form == "text":
            return str(raw)
        if raw is None or raw == "":
            return NONE
        try:
            number = Decimal(str(raw)) * Decimal(self.scale)
        except InvalidOperation:
            raise ValueError(f"{raw!r} is not a number: form {self.form!r} needs one") from None
        if not number.is_finite():
            return NONE
        if self.unsigned:
            number = abs(number)
        text = self._digits_of(number, str(raw))
        if self.form == "fixed" and not text.strip("-0."):  # rounded to zero, which has no sign
            return text.removeprefix("-")
        if text.startswith("-"):
            return MINUS + text[1:]
        return f"+{text}" if self.signed else text

    def _digits_of(self, number: Decimal, raw: str) -> str:
        """The number in its form, with an ASCII minus.   raw : as it stands in the file."""
        if not number and self.form in ("significant", "power", "bound"):
            return "0"
        match self.form:
            case "verbatim":
                mantissa, _, exponent = raw.lower().partition("e")
                return scientific(mantissa, int(exponent)) if exponent else mantissa
            case "plain":
                rounded = float(f"{number:.{_PLAIN_DIGITS}g}")
                return _thousands(f"{rounded:f}".rstrip("0").rstrip("."))
            case "fixed":
                return _thousands(f"{_rounded(number, self.digits):f}")
            case "significant":
                decimals = self.digits - 1 - number.adjusted()
                if _rounded(number, decimals).adjusted() > number.adjusted():  # 9.99 → 10.0
                    decimals -= 1
                return _thousands(f"{_rounded(number, decimals):f}")
            case "power":
                mantissa, _, exponent = f"{number:.{self.digits}e}".partition("e")
                return scientific(mantissa, int(exponent))
            case "bound":
                return ten_to(int(abs(number).log10().to_integral_value(ROUND_CEILING)))
            case _:
                return in_words(int(number)) if number == int(number) else f"{number:f}"


def _rounded(number: Decimal, digits: int) -> Decimal:
    return number.quantize(Decimal(1).scaleb(-digits), ROUND_HALF_EVEN)


def _thousands(text: str) -> str:
    """208000 → 208 000, with thin spaces; four digits stay together."""
    whole, point, rest = text.partition(".")
    if len(whole.removeprefix("-")) > 4:
        whole = f"{int(whole):,}".replace(",", THIN)
    return whole + point + rest
