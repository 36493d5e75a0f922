"""The figure of a study whose file asks for none: by its axes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from .axes import Sampled
from .parameters import PARAMETERS
from .settings import Study

MOST_COLUMNS = 6  # of panels; an axis of more values gets an axis of the figure


def usual_figures(study: Study) -> Iterator[dict[str, Any]]:
    """Figures that suit the axes of a study, the most telling first, as its file would ask for them; some may be
    refused (`checking`).

    Laws: who is taken for whom. Steps of several schemes: the error of c against the step. Runs that differ by their
    noise: statistics of their errors along the noise, or another axis. One axis: curves along it. More: a map over the
    two with the most values, but where the others have few, curves along the longest with a panel for each value of the
    next; all further axes are then at the middle of their values.
    """
    if study.route.figures == ("confusion",):
        yield {"kind": "confusion", "x": "law"}
        return
    if {"scheme", "step_s"} <= set(study.axis_names):
        yield {"kind": "steps", "x": "step_s"}
    # paired axes go in step: one of them stands for all
    names = [
        name for b in study.blocks for name in (b.names if isinstance(b, Sampled) else b.names[:1])
    ]
    values = {name: list(dict.fromkeys(study.values_of(name))) for name in names}
    sizes = {name: len(listed) or math.inf for name, listed in values.items() if len(listed) != 1}
    few = [name for name in sizes if sizes[name] <= MOST_COLUMNS]
    numbers = [name for name in sizes if not PARAMETERS[name].is_word]
    if study.route.has_intervals and "run" in sizes:
        for x in sorted(
            set(numbers) - {"run"}, key=lambda name: (name != "noise", names.index(name))
        ):
            panels = ({"panels": name} for name in few if name not in (x, "run"))
            yield {"kind": "scatter", "x": x, **next(panels, {})}
    long = sorted(numbers, key=lambda name: (-sizes[name], names.index(name)))
    if len(long) > 1 and long[1] not in few:
        yield {"kind": "map", "x": long[0], "y": long[1]}
    if long:
        other = [name for name in few if name != long[0]]
        at = {name: values[name][len(values[name]) // 2] for name in other[1:]}
        panels_by = other[0] if other else "phase"
        if other or len({fit.phase for fit in study.fits if fit.phase}) > 1:
            yield {
                "kind": "curves",
                "x": long[0],
                "panels": panels_by,
                **({"at": at} if at else {}),
            }
        else:
            yield {"kind": "curves", "x": long[0]}
