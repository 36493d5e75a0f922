"""The claims on the paper's case, judged once for all tests of this folder; no test may change them."""

from __future__ import annotations

import pytest

from replication.routes import judged


@pytest.fixture(scope="session")
def claims():
    """The table of claims."""
    return judged()


@pytest.fixture(scope="session")
def computed(claims):
    """Those on computed numbers, by id."""
    return claims[claims["kind"] == "computed"].set_index("id")
