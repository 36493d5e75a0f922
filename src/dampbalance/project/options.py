"""The options of an identification: one table, a row for each option.

Signatures and their documentation, `dampbalance identify --help`, the keys of a configured set of records with their
schema, the refusal of an option that does not apply to a kind of records, and the `options` of a document come from it.

The rows of a class belong to the same kinds of records. A type checker reads the classes as the keyword arguments of
the functions that identify; `OPTIONS` is what they say at run time.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, TypedDict, TypeVar, get_args, get_type_hints

from ..arguments import NUMBERS, Bounds, shown
from ..law.terms import KNOWN_TERMS
from .wording import listed

Function = TypeVar("Function", bound=Callable[..., Any])

Stated: TypeAlias = float | tuple[float, float] | str
"""A number in SI, alone or with its standard uncertainty, 2310.0 or (2310.0, 10.0), or a text: "2.31 ± 0.01 N/mm"."""
Held: TypeAlias = Literal["ground", "base"]
"""Either end of a rig that holds the other side of a contact."""
Contacts: TypeAlias = Literal["both", "one slider", "gradual"]
"""Contacts that can be asked for."""
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

    words : what the option is.   default : that of the function.   bounds : of a number.
    uncertainty : relative standard uncertainty of a number that states none.
    name, type, kinds : its name, the type of its value, and the kinds of records that take it.
    """

    words: str
    default: Any = None
    bounds: Bounds | None = None
    uncertainty: float = 0.0
    name: str = ""
    type: Any = None
    kinds: tuple[str, ...] = ()

    @property
    def form(self) -> str:
        """Form of its value: how it is read, from a call, a command line or a configuration."""
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
        """Return the reason why the option does not apply to a kind of records; "" where it does."""
        if kind in self.kinds:
            return ""
        kinds = listed([IN_WORDS[one] for one in self.kinds], "or")
        return f"is for {kinds}, and these are {IN_WORDS[kind]}: leave it out"


# fmt: off
class _OfRecords(TypedDict, total=False):
    mapping: Annotated[str | Path | None, Option(
        "file or folder that names the channels of the records; default, the file next to each")]


class _OfSpring(TypedDict, total=False):
    stiffness: Annotated[Stated | None, Option(
        "stiffness k of the spring (N m/rad of a rotation); it scales F_k and c", None, NUMBERS["k"])]


class _OfOscillator(TypedDict, total=False):
    # fixture, driver and half of the springs move along and are seldom weighed: 0.5 %
    mass: Annotated[Stated | None, Option(
        "mass m (kg m² of a rotation): tests stiffness and gains, sharpens K_z, or gives the stiffness where that is "
        "left out; unless stated, its standard uncertainty is 0.5 %, however many digits it has",
        None, NUMBERS["m"], 0.005)]


class _OfForced(TypedDict, total=False):
    frequency: Annotated[float | str | None, Option(
        "known drive frequency; compared with that of each record", None, NUMBERS["frequency"])]
    groups: Annotated[Groups, Option(
        "terms with a coefficient for each group of records: a label per record, as A, A, B for F_k")]
    contact_to: Annotated[Held, Option(
        "what holds the friction contact; base for a mount, whose spring, damper and friction all sit on the table "
        "and whose mass is given", "ground")]
    fixture_mass: Annotated[float | str | None, Option(
        "mass between a load cell and the vibrating mass", None, NUMBERS["m"])]


class _OfForcedOrLoops(TypedDict, total=False):
    skip_cycles: Annotated[int, Option(
        "cycles left out at the start of each record, where the motion has not settled", 0, Bounds("", 0, 1_000_000))]


class _OfDecays(TypedDict, total=False):
    pendulum: Annotated[bool, Option(
        "whether the record is the angle of a pendulum, whose restoring torque is k sin θ with k = m g L; where it is "
        "not said, that is tried if a spring does not explain the decays", False)]


class _OfForcedOrDecays(TypedDict, total=False):
    laws: Annotated[bool, Option(
        "whether to weigh the laws of one or two terms, with and without friction, and name the one that the records "
        "support", False)]


class _OfForcedOrSteppedSine(TypedDict, total=False):
    terms: Annotated[Names, Option(
        "terms of the damping law, friction among them; default, F_k, c and those given; known: "
        f"{', '.join(KNOWN_TERMS)}")]
    given: Annotated[Coefficients, Option("known coefficients of terms, SI, as 0.669 for c")]


class _OfSteppedSine(TypedDict, total=False):
    contact: Annotated[Contacts, Option(
        "one slider, that of the paper, gradual for many that slip one after the other, as in a bolted joint, or both, "
        "of which the lines choose", "both")]
    hardening: Annotated[bool, Option("whether the spring may stiffen with the amplitude", True)]
    residual: Annotated[bool, Option("whether other modes of a structure may move the driven point, too", False)]


class _OfLoops(TypedDict, total=False):
    normal_force: Annotated[Stated | None, Option(
        "normal force, for the friction coefficient μ = F_k/N, where no channel has it", None, Bounds("N"))]
    fixture_stiffness: Annotated[float | str | None, Option(
        "stiffness of a fixture in series whose deflection is also measured", None, NUMBERS["k"])]
    backlash: Annotated[bool, Option("whether a dead band in the fixture is looked for, and named", True)]
# fmt: on


class ForcedOptions(
    _OfOscillator, _OfForced, _OfForcedOrLoops, _OfForcedOrDecays, _OfForcedOrSteppedSine
):
    """Options of `identify_forced`."""


class DecayOptions(_OfOscillator, _OfDecays, _OfForcedOrDecays):
    """Options of `identify_decays`."""


class SteppedSineOptions(_OfOscillator, _OfForcedOrSteppedSine, _OfSteppedSine):
    """Options of `identify_joint`."""


class LoopOptions(_OfForcedOrLoops, _OfLoops):
    """Options of `identify_loops`."""


class SpeedOptions(TypedDict, total=False):
    """Options of `identify_friction_speed`."""


class AnyOptions(ForcedOptions, _OfDecays, _OfSteppedSine, _OfLoops):
    """Options of `identify`."""


IN_WORDS = {
    "forced": "forced records",
    "ring-down": "free decays",
    "stepped-sine": "tables of a stepped sine",
    "loops": "measured loops",
    "friction-speed": "friction at steady speeds",
}
"""Kinds of records, as messages call them."""

IN_TIME = "forced", "ring-down"
"""Kinds of records in time, of an oscillator whose stiffness or mass is given."""

_TAKEN: dict[str, tuple[type, ...]] = {
    "forced": (_OfRecords, _OfSpring, ForcedOptions),
    "ring-down": (_OfRecords, _OfSpring, DecayOptions),
    "stepped-sine": (_OfRecords, _OfSpring, SteppedSineOptions),
    "loops": (_OfRecords, LoopOptions),
    "friction-speed": (_OfRecords, SpeedOptions),
}
"""Kind of records → the rows that apply."""


def _options() -> dict[str, Option]:
    """Return the rows of the table, each with its name, type and kinds, by name."""
    options: dict[str, Option] = {}
    for rows in (_OfRecords, _OfSpring, AnyOptions):
        for name, hint in get_type_hints(rows, include_extras=True).items():
            of_type, option = get_args(hint)
            kinds = [
                k for k, of in _TAKEN.items() if any(name in each.__annotations__ for each in of)
            ]
            options[name] = replace(option, name=name, type=of_type, kinds=tuple(kinds))
    return options


OPTIONS = _options()
"""Name of an option → its row."""


def asked(kind: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that are not at their defaults, at which any may be given for any kind of records.

    kind : of the records, or "recognised", for which each option may be right.

    Raises TypeError for a name that no option has, ValueError for an option that does not apply to the kind.
    """
    given = {}
    for name, value in options.items():
        if name not in OPTIONS:
            raise TypeError(f"an identification got an unexpected keyword argument {name!r}")
        default = OPTIONS[name].default
        if value is not default and not (type(value) is type(default) and value == default):
            if kind in IN_WORDS and (words := OPTIONS[name].misplaced(kind)):
                given_as = shown(value).strip("'")  # a number may be a text
                raise ValueError(f"{name} = {given_as} {words}")
            given[name] = value
    return given


def with_options(rows: type) -> Callable[[Function], Function]:
    """Return a decorator of a function that takes the options of a class as `**options`: its signature names them,
    and its docstring has a line for each in place of {options}."""
    options = [OPTIONS[name] for name in rows.__annotations__]
    lines = [f"{of.name} : {', '.join(filter(None, (of.unit, of.words)))}." for of in options]

    def decorated(function: Function) -> Function:
        signature = inspect.signature(function)
        *parameters, rest = signature.parameters.values()
        for of in options:
            own = inspect.Parameter(of.name, rest.KEYWORD_ONLY, default=of.default)
            parameters.append(own.replace(annotation=of.type))
        function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        if function.__doc__:
            function.__doc__ = function.__doc__.replace("{options}", "\n    ".join(lines))
        return function

    return decorated


# --- a set of records in a configuration ----------------------------------------------------------


def schema_of_options(forms: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON schema of each key of a configured set of records that says what is identified, and how.

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
    """Yield each key of a set of records that does not fit the others, and why: it does not apply to the kind, is
    an uncertainty without its number, or is a stiffness that is missing."""
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
    """Return the arguments of `identify` that a set of records in a configuration states, except the records; they are
    forced unless it states another kind."""
    arguments = {"kind": settings.get("kind", "forced")}
    for of in OPTIONS.values():
        value, error = settings.get(of.key), settings.get(of.error_key)
        if value is not None:
            arguments[of.name] = value if error is None else (value, error)
    return arguments
