"""The unknowns of a model by name, with what a fit must know of each: the one vocabulary of model, fit and report."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, Mask


class Parameter(NamedTuple):
    """An unknown of a model; SI units.

    name : its symbol.   value : where it is, or where a climb starts.   low, high : its limits; infinite for one that
    may have any sign, as a phase or a logarithm.   free : whether a fit moves it; else its value is given.
    scale : size below which it counts as zero.   group : which of the records, decays or channels share it, as a label
    gives them; empty where all do.   prior : standard deviation about zero that is known beforehand; infinite for none.
    """

    name: str
    value: float
    low: float = -math.inf
    high: float = math.inf
    free: bool = True
    scale: float = 1.0
    group: str = ""
    prior: float = math.inf

    @property
    def key(self) -> str:
        """The name, with the group where it belongs to one: F_k[250 g]."""
        return f"{self.name}[{self.group}]" if self.group else self.name


class Limits(NamedTuple):
    """What a climb needs of the parameters, (p,) each, see `Parameter`."""

    free: Mask
    low: Array
    high: Array
    scale: Array


@dataclass(frozen=True, eq=False)
class Parameters:
    """All unknowns of a model in their order; the values as an array are a point of its problem.

    keys : names, with the group of those that have one.   names, groups, values, low, high, free, scale, prior : of
    each parameter, (p,).

    >>> some = Parameters.of([Parameter("F_k", 1.0, low=0.0), Parameter("m", 2.0, free=False)])
    >>> some["F_k"].value, some.held("F_k").free.tolist()
    (1.0, [False, False])
    """

    names: tuple[str, ...]
    groups: tuple[str, ...]
    values: Array
    low: Array
    high: Array
    free: Mask
    scale: Array
    prior: Array

    @classmethod
    def of(cls, parameters: Iterable[Parameter]) -> Parameters:
        """Return parameters in this order."""
        rows = [*parameters]

        def column(name: str) -> Array:
            return np.array([getattr(one, name) for one in rows], dtype=np.float64)

        return cls(
            names=tuple(one.name for one in rows),
            groups=tuple(one.group for one in rows),
            values=column("value"),
            low=column("low"),
            high=column("high"),
            free=column("free") > 0.0,
            scale=column("scale"),
            prior=column("prior"),
        )

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """Keys of all parameters, see `Parameter.key`."""
        pairs = zip(self.names, self.groups, strict=True)
        return tuple(f"{name}[{group}]" if group else name for name, group in pairs)

    @cached_property
    def places(self) -> Mapping[str, int]:
        """Place of each key."""
        return {key: i for i, key in enumerate(self.keys)}

    @property
    def by_key(self) -> dict[str, float]:
        """Value of each key."""
        return dict(zip(self.keys, self.values.tolist(), strict=True))

    def __len__(self) -> int:
        """Return their number."""
        return len(self.names)

    def __iter__(self) -> Iterator[Parameter]:
        """Yield each parameter."""
        return map(self._one, range(len(self)))

    def __contains__(self, key: str) -> bool:
        """Return whether there is a parameter of this key."""
        return key in self.places

    def __getitem__(self, key: str) -> Parameter:
        """Return the parameter of a key."""
        return self._one(self.places[key])

    def _one(self, i: int) -> Parameter:
        columns = (self.values, self.low, self.high, self.free, self.scale)
        value, low, high, free, scale = (of[i].item() for of in columns)
        group, prior = self.groups[i], float(self.prior[i])
        return Parameter(self.names[i], value, low, high, free, scale, group, prior)

    @property
    def limits(self) -> Limits:
        """What a climb needs of them."""
        return Limits(self.free, self.low, self.high, self.scale)

    def at(self, values: Array) -> Parameters:
        """Return them with other values, (p,)."""
        return replace(self, values=values)

    def moved(self, **values: float) -> Parameters:
        """Return them with other values of some, by key."""
        return self.at(self._changed(self.values, values))

    def freed(self, *keys: str) -> Parameters:
        """Return them with some that are free."""
        return replace(self, free=self._changed(self.free, dict.fromkeys(keys, True)))

    def held(self, *keys: str) -> Parameters:
        """Return them with some that keep their values."""
        return replace(self, free=self._changed(self.free, dict.fromkeys(keys, False)))

    def _changed(self, of: Any, changes: Mapping[str, Any]) -> Any:
        changed = of.copy()
        for key, value in changes.items():
            changed[self.places[key]] = value
        return changed
