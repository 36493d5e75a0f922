"""What the set-up compiles can be computed."""

from __future__ import annotations

import pytest

from dampbalance.commands import kernels


@pytest.mark.parametrize("part", kernels.PARTS)
def test_each_part_of_the_set_up_runs(part):
    kernels.main([part])
