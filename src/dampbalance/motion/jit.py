"""Compile numerical kernels with Numba, once per version of their source.

Numba's own disk cache looks only at the file of the compiled function: a kernel goes on being served from the cache
after a kernel that it calls, in another file, was edited. Here the cache folder carries a digest of every module that
kernels are made of: an edit of any of them means a fresh compilation, and two versions of the package never share one.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config

numba_config: Any = config

Function = TypeVar("Function", bound=Callable[..., object])

_PACKAGE = Path(__file__).parents[1]


def _sources() -> list[Path]:
    """The modules that kernels are made of: this room and the factorisation, and what they import from the root."""
    root = ("arrays", "factorisation", "model", "record")
    return [*(_PACKAGE / f"{name}.py" for name in root), *sorted(_PACKAGE.glob("motion/*.py"))]


def _source_digest() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in _sources():
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path | None:
    """Where compiled kernels are kept: beside the package if that can be written, else the user's cache folder."""
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


_FOLDER = _cache_folder()


def jit(function: Function) -> Function:
    """Compile `function` to machine code: no global lock held, strict IEEE arithmetic, cached on disk."""
    if _FOLDER is None:
        return cast(Function, numba.njit(nogil=True)(function))
    previous = numba_config.CACHE_DIR
    numba_config.CACHE_DIR = str(_FOLDER)  # read by Numba while it decorates, and only then
    try:
        return cast(Function, numba.njit(nogil=True, cache=True)(function))
    finally:
        numba_config.CACHE_DIR = previous
