"""Terms of a law, with the coefficients that are known and those that belong to a group of records only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ..arguments import NUMBERS, items, mapping, names, number
from .terms import FRICTION, Term, in_order, term

_GIVEN = "a mapping of symbols to coefficients"


@dataclass(frozen=True)
class Law:
    """A damping law to be identified; friction is one of its terms.

    terms : symbols of `KNOWN_TERMS`.
    given : term → its known coefficient, SI.
    groups : term → the label of each record's group; records of one group share the coefficient. A term without groups
    has one coefficient for all records. In both, a symbol stands for its term.

    Raises ValueError naming the term that is unknown, not among `terms`, given a value that no oscillator has, or both
    given and grouped, and for a law without friction.
    """

    terms: tuple[Term, ...] = (FRICTION, "c")  # type: ignore[assignment]
    given: Mapping[str, float] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", in_order(names("terms", self.terms)))
        object.__setattr__(self, "given", mapping("given", self.given, _GIVEN))
        groups = mapping("groups", self.groups, "a mapping of symbols to a label for each record")
        for symbol, of in groups.items():
            name = f"groups of {symbol}"
            given = of if isinstance(of, str) else map(str, items(name, of, "labels"))
            groups[symbol] = names(name, given)
        object.__setattr__(self, "groups", groups)
        if FRICTION not in self.terms:
            raise ValueError(
                f"a law needs the friction force {FRICTION}, got the terms {', '.join(self.terms) or 'none'}"
            )
        for what, name in (("given", "given"), ("grouped", "groups")):
            named = getattr(self, name)
            for symbol in named:
                if symbol not in self.terms:
                    term(symbol)  # raises with the known ones
                    raise ValueError(
                        f"{symbol} is {what} and no term of the law: add it to the terms {', '.join(self.terms)}"
                    )
            object.__setattr__(self, name, {self.term(symbol): of for symbol, of in named.items()})
        for symbol, value in self.given.items():
            label = f"the given {symbol} ({self.term(symbol).unit or 'no unit'})"
            if number(label, value, NUMBERS["given"]) == 0.0 and symbol == FRICTION:
                raise ValueError(f"the given {symbol} must be a positive number of N, got {value}")
            if symbol in self.groups:
                raise ValueError(
                    f"{symbol} is given and cannot have groups: leave out one of the two"
                )
        for symbol, labels in self.groups.items():
            if not labels or not all(label and not set(label) & set("[]") for label in labels):
                raise ValueError(
                    f"the groups of {symbol} must be names without brackets, one for each record, got {list(labels)}"
                )

    @cached_property
    def keys(self) -> tuple[Term, ...]:
        """The keys of all coefficients, in order: a term, or one for each group of its records, F_k[250 g]."""
        return tuple(key for term in self.terms for key in self.keys_of(term))

    def term(self, symbol: str) -> Term:
        """Return the term of the law that has a symbol."""
        return self.terms[self.terms.index(symbol)]

    @property
    def unknowns(self) -> tuple[Term, ...]:
        """The keys of the coefficients that are to be identified."""
        return tuple(key for key in self.keys if key not in self.given)

    @cached_property
    def nonlinear(self) -> tuple[Term, ...]:
        """The terms under which the motion between two events has no closed form."""
        return tuple(term for term in self.terms if term != FRICTION and not term.linear)

    def key(self, symbol: str, record: int) -> Term:
        """Return the key of the coefficient that a term has for a record, counted from 0."""
        term, labels = self.term(symbol), self.groups.get(symbol)
        return term if labels is None else term.of_group(labels[record])

    def keys_of(self, symbol: str) -> tuple[Term, ...]:
        """Return the keys of all coefficients of a term."""
        term, labels = self.term(symbol), self.groups.get(symbol)
        return (term,) if labels is None else tuple(map(term.of_group, dict.fromkeys(labels)))

    def require_labels(self, records: int) -> None:
        """Raise ValueError unless the groups of each term have a label for each record.   records : their number."""
        for symbol, labels in self.groups.items():
            if len(labels) != records:
                raise ValueError(
                    f"the groups of {symbol} have {len(labels)} labels for {records} records: give one for each"
                )

    def require(self, frequencies_hz: Sequence[float], *, by_balance: bool = True) -> None:
        """Raise ValueError where records at these frequencies, one each, cannot distinguish the terms.

        by_balance : whether the energy balance is to do so, which needs a record for each unknown; waveforms may need
        fewer.
        """
        count = len(frequencies_hz)
        self.require_labels(count)
        alike = [s for s in ("c", "eta") if s in self.terms and s not in self.given]
        # ratio of two frequencies: nearer ones count as one
        if len(alike) > 1 and max(frequencies_hz) < 1.001 * min(frequencies_hz):
            raise ValueError(
                f"at one frequency ({frequencies_hz[0]:.4g} Hz) structural damping eta and viscous damping c act "
                "alike, c = eta k/omega: leave out one of them, or add records at another frequency"
            )
        if not self.unknowns:
            raise ValueError("every coefficient is given: leave out one, to identify it")
        if by_balance and count < len(self.unknowns):
            n = len(self.unknowns)
            levels = "two levels" if n == 2 else f"{n} levels"
            raise ValueError(
                f"{n} coefficients need responses at {levels} or more, got {count}: add records at other amplitudes"
            )


def law_of(
    terms: Sequence[str] | str | None,
    given: Mapping[str, float] | None,
    groups: Mapping[str, Sequence[str] | str] | None,
) -> Law:
    """Return the law that a user's options describe.

    terms : default, F_k, c and those that are given.   given, groups : as in `Law`. Names and labels may be one
    comma-separated string.

    Raises ValueError naming what is wrong.
    """
    known = {} if given is None else mapping("given", given, _GIVEN)
    asked = () if terms is None else names("terms", terms)
    return Law(asked or (*Law().terms, *known), known, {} if groups is None else groups)  # type: ignore[arg-type]
