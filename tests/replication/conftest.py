"""The claims on the paper's case, judged once for all tests of this folder."""

from __future__ import annotations

import pytest

from replication.routes import judged


@pytest.fixture(scope="session")
def claims():
    """The table of claims; no test may change it."""
    return judged()
