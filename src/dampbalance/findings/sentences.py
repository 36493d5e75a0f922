"""The one table of findings: code → sentence, remedy, section of the site. `words` says how templates are filled."""

from __future__ import annotations

from collections.abc import MutableMapping
from typing import NamedTuple


class Sentence(NamedTuple):
    """What a finding says.

    words : what it is and how large, a template.   remedy : what helps, a template; empty where nothing does or the
    words say it.   page : the section of the site's page of symptoms that explains it.   spares : names of the answers
    that it does not concern.
    """

    words: str
    remedy: str = ""
    page: str = ""
    spares: tuple[str, ...] = ()


SENTENCES: MutableMapping[str, Sentence] = {
    "clipped": Sentence(
        "{quantity:noun} is clipped: in {cycles:.0f %} of the cycles several samples hold the extreme value; amplitude "
        "and harmonics are too small",
        "raise the measuring range, unless the mass stops there",
        page="clipped",
    ),
    "not steady": Sentence(
        "{what} is not steady: its amplitude changes by {change:percent}, its phasor by up to {turn:percent} during "
        "the record (chance of that in noise: {p:chance})[phase?; only its phase drifts, as with two sampling clocks "
        "or growing friction]",
        "[after?it settles after about {after:.0f} cycles: leave those out (--skip-cycles {skip:.0f})|leave out cycles "
        "at its start (--skip-cycles), or record again after the motion has settled]",
        page="unsettled",
    ),
}
"""Code → what the finding says. One more is one entry here."""
