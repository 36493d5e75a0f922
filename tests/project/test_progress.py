"""One line of a terminal says how far a loop is; a log and a pipe hold nothing of it."""

from __future__ import annotations

import io
import sys

import pytest

from dampbalance.project import progress
from dampbalance.project.progress import duration_in_words, followed


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass with each item."""
    passed = iter(range(0, 1000, 3))
    monkeypatch.setattr(progress.time, "monotonic", lambda: float(next(passed)))


def test_a_terminal_shows_what_is_done_and_left(clock, monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    assert list(followed("abcd", 4, "letters")) == [*"abcd"]
    shown = sys.stderr.getvalue().split(progress.WIPE)
    # three seconds to the first item and three to each that follows
    assert shown == [
        "",
        *(f"{n} of 4 letters, about {s} s left" for n, s in ((1, 18), (2, 9), (3, 4))),
        "",
    ]


def test_a_pipe_shows_nothing(clock, monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    assert list(followed(range(9), 9, "numbers")) == [*range(9)]
    assert sys.stderr.getvalue() == ""


def test_a_loop_within_a_loop_is_silent(clock, monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    for _ in followed(range(3), 3, "outer"):
        list(followed(range(3), 3, "inner"))
    assert "inner" not in sys.stderr.getvalue()
    assert "outer" in sys.stderr.getvalue()


@pytest.mark.parametrize(
    ("seconds", "words"), [(12.4, "12 s"), (240.0, "4 min"), (12600.0, "3.5 h")]
)
def test_durations_in_words(seconds, words):
    assert duration_in_words(seconds) == words
