"""The options of an identification: one table, a row for each option.

The documentation of signatures, `dampbalance identify --help`, the keys of a configured set of records with their
schema, the refusal of an option that does not apply to a kind of records, and the `options` of a document derive from
it. The signatures themselves are written out for editors, type checkers and `help`;
`tests/identification/test_identified.py` compares their names, types and defaults with the table.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar, get_args

from ..arguments import NUMBERS, Bounds, shown
from ..law.terms import KNOWN_TERMS
from .wording import did_you_mean, listed

Function = TypeVar("Function", bound=Callable[..., Any])

Stated: TypeAlias = float | tuple[float, float] | str
"""A number in SI, alone or with its standard uncertainty, 2310.0 or (2310.0, 10.0), or a text: "2.31 ± 0.01 N/mm"."""
Names: TypeAlias = Sequence[str] | str | None
Coefficients: TypeAlias = Mapping[str, float] | None
Groups: TypeAlias = Mapping[str, Sequence[str] | str] | None

_FORMS = {
    **{bool: "flag", int: "whole", float | str | None: "number", Stated | None: "stated"},
    **{str | Path | None: "path", Names: "names", Coefficients: "coefficients", Groups: "labels"},
}
"""Type of the value of an option → its form; others are a "choice"."""


@dataclass(frozen=True)
class Option:
    """A row of the table.

    name : of the argument.
    kinds : the kinds of records to which it applies.
    type, default : of the argument.
    words : its description.
    bounds : of a number.
    uncertainty : relative standard uncertainty of a number that is stated without one.
    """

    name: str
    kinds: Sequence[str]
    type: Any
    default: Any
    words: str
    bounds: Bounds | None = None
    uncertainty: float = 0.0

    @property
    def form(self) -> str:
        """Form of its value, by which a call, the command line and a configuration read it."""
        return _FORMS.get(self.type, "choice")

    @property
    def unit(self) -> str:
        """Unit of a number, SI; "" where it has none."""
        return self.bounds.unit if self.bounds else ""

    @property
    def key(self) -> str:
        """Key of a configuration and of a document: the name with its unit, frequency_hz."""
        unit = self.unit.replace("/", "_per_").replace("Hz", "hz")
        return f"{self.name}_{unit}".removesuffix("_")

    @property
    def error_key(self) -> str:
        """Key of the standard uncertainty; "" where there is none."""
        return self.key.replace(self.name, f"{self.name}_standard_error") * (self.form == "stated")

    def misplaced(self, kind: str) -> str:
        """Return why the option does not apply to a kind of records; "" if it does."""
        if kind in self.kinds:
            return ""
        kinds = listed([IN_WORDS[one] for one in self.kinds], "or")
        return f"is for {kinds}, and these are {IN_WORDS[kind]}: leave it out"


IN_WORDS = {
    "forced": "forced records",
    "ring-down": "free decays",
    "stepped-sine": "tables of a stepped sine",
    "loops": "measured loops",
    "friction-speed": "friction at steady speeds",
}
"""Kind of records → its name in messages."""

IN_TIME = "forced", "ring-down"
"""Kinds that are time histories of an oscillator, and need its stiffness or mass."""

_FORCED, _DECAYS, _SINE, _LOOPS, _SPEEDS = ((kind,) for kind in IN_WORDS)
_OF_OSCILLATOR = _FORCED + _DECAYS + _SINE

# fmt: off
_ROWS = (
    Option("mapping", tuple(IN_WORDS), str | Path | None, None,
        "file or folder that names the channels of the records; default, the file next to each"),
    Option("stiffness", _OF_OSCILLATOR, Stated | None, None,
        "stiffness k of the spring (N m/rad of a rotation); it scales F_k and c", NUMBERS["k"]),
    # fixture, driver and half of the springs move along and are seldom weighed: 0.5 %
    Option("mass", _OF_OSCILLATOR, Stated | None, None,
        "mass m (kg m² of a rotation): tests stiffness and gains, sharpens K_z, or gives the stiffness where that is "
        "left out; unless stated, its standard uncertainty is 0.5 %, however many digits it has",
        NUMBERS["m"], 0.005),
    Option("frequency", _FORCED, float | str | None, None,
        "known drive frequency; compared with that of each record", NUMBERS["frequency"]),
    Option("groups", _FORCED, Groups, None,
        "terms with a coefficient for each group of records: a label per record, as A, A, B for F_k"),
    Option("contact_to", _FORCED, Literal["ground", "base"], "ground",
        "what holds the friction contact; base for a mount, whose spring, damper and friction all sit on the table "
        "and whose mass is given"),
    Option("fixture_mass", _FORCED, float | str | None, None,
        "mass between a load cell and the vibrating mass", NUMBERS["m"]),
    Option("skip_cycles", _FORCED + _LOOPS, int, 0,
        "cycles left out at the start of each record, where the motion has not settled", Bounds("", 0, 1_000_000)),
    Option("laws", _FORCED + _DECAYS, bool, False,
        "whether to weigh the laws of one or two terms, with and without friction, and name the one that the records "
        "support"),
    Option("terms", _FORCED + _SINE, Names, None,
        "terms of the damping law, friction among them; default, F_k, c and those given; known: "
        f"{', '.join(KNOWN_TERMS)}"),
    Option("given", _FORCED + _SINE, Coefficients, None, "known coefficients of terms, SI, as 0.669 for c"),
    Option("pendulum", _DECAYS, bool, False,
        "whether the record is the angle of a pendulum, whose restoring torque is k sin θ with k = m g L; where it is "
        "not said, that is tried if a spring does not explain the decays"),
    Option("contact", _SINE, Literal["both", "one slider", "gradual"], "both",
        "one slider, that of the paper, gradual for many that slip one after the other, as in a bolted joint, or both, "
        "of which the lines choose"),
    Option("hardening", _SINE, bool, True, "whether the spring may stiffen with the amplitude"),
    Option("residual", _SINE, bool, False, "whether other modes of a structure may move the driven point, too"),
    Option("normal_force", _LOOPS, Stated | None, None,
        "normal force, for the friction coefficient μ = F_k/N, where no channel has it", Bounds("N")),
    Option("fixture_stiffness", _LOOPS, float | str | None, None,
        "stiffness of a fixture in series whose deflection is also measured", NUMBERS["k"]),
    Option("backlash", _LOOPS, bool, True, "whether a dead band in the fixture is looked for, and named"),
)
# fmt: on

OPTIONS = {of.name: of for of in _ROWS}
"""Name of an option → its row."""


def options_of(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options among the arguments of a function that identifies, including those in `unknown`.

    arguments : `locals()`, before any other name is assigned.
    """
    named = {name: value for name, value in arguments.items() if name in OPTIONS}
    return {**named, **arguments["unknown"]}


def asked(kind: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that differ from their defaults; an option at its default is accepted for every kind.

    kind : of the records, or "recognised", to which every option may apply.

    Raises TypeError for an unknown name, ValueError for an option that does not apply to the kind.
    """
    given = {}
    for name, value in options.items():
        if name not in OPTIONS:
            near = did_you_mean(name, [*OPTIONS, "kind"]) or ": help(identify) shows all"
            raise TypeError(f"unexpected keyword argument {name!r}{near}")
        default = OPTIONS[name].default
        if value is not default and not (type(value) is type(default) and value == default):
            if kind in IN_WORDS and (words := OPTIONS[name].misplaced(kind)):
                given_as = shown(value).strip("'")  # a number may be a text
                raise ValueError(f"{name} = {given_as} {words}")
            given[name] = value
    return given


_DESCRIBED = "The options of the signature, which `help` describes."
"""Sentence of a docstring that `with_options` replaces by the descriptions of the options."""


def with_options(function: Function) -> Function:
    """Decorate a function that identifies: add a line for each option of its signature to its docstring."""
    own = [OPTIONS[n] for n in inspect.signature(function).parameters if n in OPTIONS]
    lines = [
        f"{of.name} : {', '.join(filter(None, (of.unit, of.words)))}."
        for of in own
        if of.name not in ("stiffness", "mapping")  # which the docstring itself describes
    ]
    lines += ["unknown : no other; a misspelt one raises TypeError with the name that was meant."]
    words = (
        inspect.getdoc(function) or ""
    )  # none under python -OO; without indentation in any version
    function.__doc__ = words.replace(_DESCRIBED, "\n".join(lines))
    return function


# --- a set of records in a configuration ----------------------------------------------------------


def schema_of_options(forms: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON schema of the keys of a configured set of records that set options.

    forms : form of a value → its schema.
    """
    kinds = listed([f"{kind} ({words})" for kind, words in IN_WORDS.items()], "or")
    keys: dict[str, Any] = {
        "kind": {"description": f"{kinds}; forced if left out.", "enum": list(IN_WORDS)}
    }
    for of in OPTIONS.values():
        choice = {"enum": list(get_args(of.type))}
        schema, words = dict(choice if of.form == "choice" else forms[of.form]), of.words
        if of.bounds is not None:
            schema |= {"minimum": of.bounds.low, "maximum": of.bounds.high}
            words = f"{of.bounds}: {words}"
        default = "may be null or" if of.default is None else f"{of.default} if".lower()
        schema["description"] = f"{words[0].upper()}{words[1:]}; {default} left out."
        keys[of.key] = schema
        if of.error_key:
            words = f"Standard uncertainty of {of.key}, below it; null or left out where it is not known."
            keys[of.error_key] = {**schema, "description": words, "minimum": 0.0}
    return keys


def contradictions(settings: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield each key of a set of records that contradicts the others, with the reason: an option that does not apply to
    the kind, an uncertainty without its number or above it, or a missing stiffness."""
    kind = settings.get("kind", "forced")
    stated = {key: value for key, value in settings.items() if value is not None}
    for of in OPTIONS.values():
        if words := of.misplaced(kind):
            yield from ((key, words) for key in (of.key, of.error_key) if key in stated)
        elif of.error_key in stated and of.key not in stated:
            words = f"has no effect without {of.key}, whose uncertainty it is: add that, or leave it out"
            yield of.error_key, words
        elif of.error_key in stated and not stated[of.error_key] < stated[of.key]:
            yield of.error_key, f"must be below {of.key} = {stated[of.key]:g}: correct one of them"
    k, m = OPTIONS["stiffness"].key, OPTIONS["mass"].key
    if kind in IN_TIME and not {k, m} & stated.keys():
        yield k, f"is missing: {IN_WORDS[kind]} need it, or the mass; add it"


def configured(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of `identify` for a configured set of records, except the records themselves; the kind is
    "forced" unless the set states another."""
    arguments = {"kind": settings.get("kind", "forced")}
    for of in OPTIONS.values():
        value, error = settings.get(of.key), settings.get(of.error_key)
        if value is not None:
            arguments[of.name] = value if error is None else (value, error)
    return arguments
