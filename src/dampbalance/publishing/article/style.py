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
        return _signed(_FORMS[self.form](number, self.digits, str(raw)), self.signed)


def _verbatim(number: Decimal, digits: int, raw: str) -> str:
    mantissa, _, exponent = raw.lower().partition("e")
    return scientific(mantissa, int(exponent)) if exponent else mantissa


def _plain(number: Decimal, digits: int, raw: str) -> str:
    return _thousands(f"{float(f'{number:.{_PLAIN_DIGITS}g}'):f}".rstrip("0").rstrip("."))


def _fixed(number: Decimal, digits: int, raw: str) -> str:
    return _thousands(f"{_rounded(number, digits):f}")


def _significant(number: Decimal, digits: int, raw: str) -> str:
    if not number:
        return "0"
    decimals = digits - 1 - number.adjusted()
    if _rounded(number, decimals).adjusted() > number.adjusted():  # 9.99 → 10.0
        decimals -= 1
    return _thousands(f"{_rounded(number, decimals):f}")


def _with_power(number: Decimal, digits: int, raw: str) -> str:
    if not number:
        return "0"
    mantissa, _, exponent = f"{number:.{digits}e}".partition("e")
    return scientific(mantissa, int(exponent))


def _bound(number: Decimal, digits: int, raw: str) -> str:
    if not number:
        return "0"
    return ten_to(int(abs(number).log10().to_integral_value(ROUND_CEILING)))


def _word(number: Decimal, digits: int, raw: str) -> str:
    return in_words(int(number)) if number == int(number) else f"{number:f}"


_FORMS = {
    "verbatim": _verbatim,
    "plain": _plain,
    "fixed": _fixed,
    "significant": _significant,
    "power": _with_power,
    "bound": _bound,
    "word": _word,
}


def _rounded(number: Decimal, digits: int) -> Decimal:
    return number.quantize(Decimal(1).scaleb(-digits), ROUND_HALF_EVEN)


def _thousands(text: str) -> str:
    """208000 → 208 000, with thin spaces; four digits stay together."""
    whole, point, rest = text.partition(".")
    sign = whole[:1] if whole.startswith("-") else ""
    digits = whole.removeprefix("-")
    if len(digits) > 4:
        digits = f"{int(digits):,}".replace(",", THIN)
    return f"{sign}{digits}{point}{rest}"


def _signed(text: str, signed: bool) -> str:
    if text.startswith("-"):
        return MINUS + text[1:]
    return f"+{text}" if signed else text
