"""Sums of linear algebra do not depend on how many processors there are."""

from __future__ import annotations

from dampbalance.signals.one_thread import _CONTROLLER, one_thread


def threads():
    """Of each library of linear algebra that NumPy uses."""
    return [
        library["num_threads"] for library in _CONTROLLER.info() if library["user_api"] == "blas"
    ]


def test_a_function_has_one_thread_and_what_follows_as_many_as_before():
    before = threads()
    assert before
    with _CONTROLLER.limit(limits=3, user_api="blas"):
        assert set(one_thread(threads)()) == {1}
        assert set(threads()) == {3}
    assert threads() == before


def test_arguments_and_results_pass_through():
    @one_thread
    def joined(a: str, *, b: str = "b") -> str:
        return a + b

    assert joined("a", b="c") == "ac"
    assert joined.__name__ == "joined"
