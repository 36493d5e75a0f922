"""A record as an identification takes it: the channels of one response, in SI units, each with its own times.

The channels may have different time bases, offsets and noise, and the excitation may be a motion of the base or a
force. `signals/conditioning.py` turns them into harmonics.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import instance, items, mapping, text
from ..arrays import Array, ReadOnly
from ..findings.finding import Finding
from ..findings.words import sentence
from ..project.wording import listed
from .channel import EXCITATIONS, QUANTITIES, RESPONSES, Channel, mean_rate, require_one_coordinate
from .coordinate import TRANSLATION, Coordinate
from .mapping import RecordMapping
from .units import column_name

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Record:
    """A record of a steady response at one level of excitation, or of free decays: at least one response and, unless
    it is of free decays, one excitation. `record["displacement"]` is a channel.

    name : for messages and tables; the path of a file.   channels : by quantity.   label : of the level, for plots;
    default, the name.   rules : its mapping.   warnings : what is odd about it.   files : digests of its files.

    Raises ValueError naming the record if there is no response or more than one excitation.
    """

    name: str
    channels: Mapping[str, Channel]
    label: str = ""
    rules: RecordMapping = field(default_factory=RecordMapping)
    warnings: tuple[Finding, ...] = ()
    files: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        text("name", self.name)
        channels = mapping("channels", self.channels, "a mapping of quantities to channels")
        self.__dict__.update(channels=ReadOnly(channels), label=self.label or self.name)
        for quantity, channel in channels.items():
            if quantity != (held := instance(quantity, channel, Channel).quantity):
                raise ValueError(f"{self.name}: the channel under {quantity!r} holds {held!r}")
        require_one_coordinate(self.name, {of.name: of.coordinate for of in channels.values()})
        driving = [q for q in EXCITATIONS if q in channels]
        if len(driving) > 1:
            needed = f"one excitation ({', '.join(EXCITATIONS)}), or none for a free decay"
            raise ValueError(f"{self.name}: needs {needed}, found {' and '.join(driving)}")
        if not self.responses:
            needed = f"a response ({', '.join(RESPONSES)})"
            raise ValueError(f"{self.name}: needs {needed}, found none")

    @classmethod
    def of(cls, name: str, channels: Iterable[Channel]) -> Record:
        """Return a record of these channels. Raises ValueError if two hold the same quantity."""
        by_quantity: dict[str, Channel] = {}
        for channel in items("channels", channels, "a sequence of channels"):
            instance("each of the channels", channel, Channel)
            other = by_quantity.setdefault(channel.quantity, channel)
            if other is not channel:
                require_one_coordinate(name, {of.name: of.coordinate for of in (other, channel)})
                both = f"the channels {other.name!r} and {channel.name!r} both"
                raise ValueError(f"{name}: {both} hold {channel.quantity}")
        return cls(name, by_quantity)

    def __getitem__(self, quantity: str) -> Channel:
        return self.channels[quantity]

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)

    def __contains__(self, quantity: object) -> bool:
        return quantity in self.channels

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that it holds, of `records.channel.QUANTITIES`."""
        return tuple(self.channels)

    def corrected(self) -> Record:
        """Return the record with the known gain, delay and filters of each channel removed from its samples."""
        return replace(self, channels={q: of.corrected() for q, of in self.channels.items()})

    @property
    def coordinate(self) -> Coordinate:
        """The coordinate: a motion along a line, or a rotation."""
        return next((of.coordinate for of in self.channels.values()), TRANSLATION)

    @property
    def timed(self) -> bool:
        """Whether its samples have times; if not, `t` of a channel counts samples."""
        return all(of.timed for of in self.channels.values())

    @property
    def driven(self) -> bool:
        """Whether there is an excitation; a record without one is of free decays."""
        return not self.channels.keys().isdisjoint(EXCITATIONS)

    @property
    def excitation(self) -> Channel:
        """The channel that drives the oscillator. Raises ValueError if there is none."""
        if not self.driven:
            needed = f"one excitation ({', '.join(EXCITATIONS)})"
            raise ValueError(f"{self.name}: needs {needed}, found none")
        return next(self[q] for q in EXCITATIONS if q in self)

    @property
    def responses(self) -> tuple[Channel, ...]:
        """The channels of the mass, in the order of `RESPONSES`."""
        return tuple(self[q] for q in RESPONSES if q in self)

    def columns(self) -> dict[str, Array]:
        """Return the samples as columns named with their SI units, after their times: time_s for all channels, or
        displacement_time_s etc. if they differ; without times, sample, the number of each."""
        channels = [self[q] for q in QUANTITIES if q in self]
        shared = all(np.array_equal(of.t, channels[0].t) for of in channels)
        columns: dict[str, Array] = {}
        for of in channels:
            times = "time_s" if shared else f"{of.coordinate.key(of.quantity)}_time_s"
            times = times if self.timed else "sample"
            columns |= {times: of.t, column_name(of.quantity, of.coordinate): of.as_recorded}
        return columns

    def to_frame(self) -> pd.DataFrame:
        """Return the samples as a table: a column for each channel, named with its SI unit, and the times, time_s, as
        index; without times, sample, the number of each.

        Raises ValueError if the channels have different times.
        """
        import pandas as pd  # slow to import

        columns = self.columns()
        index = next(iter(columns))
        if index not in ("time_s", "sample"):
            remedy = "take each from the record by its quantity"
            raise ValueError(f"{self.name}: its channels have different times; {remedy}")
        return pd.DataFrame(columns).set_index(index)

    def __repr__(self) -> str:
        """Summarize the record in a line."""
        held = listed([self.coordinate.noun(quantity) for quantity in self.quantities])
        t = max((of.t for of in self.channels.values()), key=len)
        sampled = f"{t.size:,} samples without times"
        if self.timed:
            span = f"from {t[0]:.4g} s to {t[-1]:.4g} s at {mean_rate(t):.6g} Hz"
            sampled = f"{t.size:,} samples {span}"
        odd = [sentence(one, self.coordinate) for one in self.warnings]
        return f"<record {self.name}: {'; '.join([held, sampled, *odd])}>"
