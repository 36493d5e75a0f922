"""Compile numerical kernels with Numba, when they are first called and once per version of their source: for the
processor, for WebAssembly (`dampbalance.publishing.engine`) and for a GPU (`dampbalance.motion.device`).

Numba's own disk cache looks only at the file of the compiled function: a kernel goes on being served from the cache
after a kernel that it calls, in another file, was edited. Here the cache folder carries a digest of every module that
kernels are made of: an edit of any of them means a fresh compilation, and two versions of the package never share one.

Numba itself is imported by the first call, so that commands which call no kernel start without it.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])

_PACKAGE = Path(__file__).parent
_OTHERS = (
    *("arguments", "arrays", "jit", "model", "law/contact", "fit/climb", "fit/parameters"),
    *(f"replication/{name}" for name in ("fixed_step", "record", "sampled")),
)
_LOCK = threading.RLock()
_target = threading.local()  # .cuda : whether this thread compiles for a GPU


def _sources() -> list[Path]:
    """Return the modules that kernels are made of, and those that they import."""
    return [*sorted(_PACKAGE.glob("motion/*.py")), *(_PACKAGE / f"{name}.py" for name in _OTHERS)]


def _source_digest() -> str:
    from importlib.metadata import version

    digest = hashlib.sha256(version("numba").encode())
    for path in _sources():
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path | None:
    """Return the folder of compiled kernels: next to the package if that can be written, else in the user's cache
    folder."""
    parents = [_PACKAGE / "__pycache__"]
    with contextlib.suppress(RuntimeError):  # a user without a home
        user_cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        parents.append(user_cache / "dampbalance")
    for parent in parents:
        folder = parent / f"kernels-{_source_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


@functools.cache
def _folder() -> Path | None:
    """Return the cache folder of this process; while it is empty, print why the first call takes long."""
    folder = _cache_folder()
    if folder is None:
        kept = "again in every process, as no folder for them can be written"
    else:
        kept = "" if any(folder.iterdir()) else "once, and keeping them"
    if kept:
        # a notebook shows stderr in red, as if something had gone wrong
        stream = sys.stdout if "ipykernel" in sys.modules else sys.stderr
        print(f"dampbalance: compiling its kernels ({kept}) …", file=stream)
    return folder


def _compiled(function: Callable[..., object]) -> Any:
    """Return the dispatcher of Numba: no global lock held, strict IEEE arithmetic, cached on disk."""
    import numba
    from numba.core import config

    folder = _folder()
    if folder is None:
        return numba.njit(nogil=True)(function)
    numba_config: Any = config
    previous = numba_config.CACHE_DIR
    numba_config.CACHE_DIR = str(folder)  # read by Numba while it decorates, and only then
    try:
        return numba.njit(nogil=True, cache=True)(function)
    finally:
        numba_config.CACHE_DIR = previous


class _Kernel:
    """A function that is compiled when it is first called, from Python or from another kernel."""

    def __init__(self, function: Callable[..., object]) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function
        self._dispatcher: Any = None
        self._on_device: Any = None

    @property
    def dispatcher(self) -> Any:
        """Numba's, made when it is first asked for, by one of the threads that ask."""
        if self._dispatcher is None:
            with _LOCK:
                if self._dispatcher is None:
                    self._dispatcher = _compiled(self.py_func)
        return self._dispatcher

    @property
    def _numba_type_(self) -> Any:
        """Type that Numba asks of a name that a kernel uses."""
        if not getattr(_target, "cuda", False):
            return self.dispatcher._numba_type_
        if self._on_device is None:
            from numba import cuda

            compiler: Any = cuda  # has no types
            self._on_device = compiler.jit(device=True)(self.py_func)
        return self._on_device._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        return self.dispatcher(*arguments)


def jit(function: Function) -> Function:
    """Compile `function` to machine code when it is first called; see `_compiled`."""
    return cast(Function, _Kernel(function))


@contextlib.contextmanager
def for_device() -> Iterator[None]:
    """Compile kernels for a GPU that a kernel of CUDA calls, in this thread."""
    _target.cuda = True
    try:
        yield
    finally:
        _target.cuda = False
