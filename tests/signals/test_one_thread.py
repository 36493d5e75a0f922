"""Sums of linear algebra do not depend on how many processors there are."""

from __future__ import annotations

from dampbalance.signals.one_thread import _CONTROLLER, one_thread


def threads(*given):
    """Of each library of linear algebra that NumPy uses."""
    own = [library for library in _CONTROLLER.info() if library["user_api"] == "blas"]
    return (*given, *(library["num_threads"] for library in own))


def test_a_function_has_one_thread_and_what_follows_as_many_as_before():
    with _CONTROLLER.limit(limits=3, user_api="blas"):
        assert {*one_thread(threads)("given")} == {"given", 1}
        assert {*threads()} == {3}
