"""Troubles of the machine, not of the input: a full disk, a folder that cannot be written, too little memory."""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Sequence
from types import TracebackType
from typing import TextIO


def trouble(error: BaseException) -> str | None:
    """Return one sentence on what the machine lacks and what to do about it; None for an error of any other kind."""
    if isinstance(error, MemoryError):
        return "memory ran out: use fewer processors (make CORES=1), or smaller chunks of a study"
    if isinstance(error, OSError):
        file = error.filename or "a file"
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            return f"{file} cannot be written, as the disk is full: make room, then repeat the same command"
        if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
            return f"{file} cannot be written or read: change its permissions"
    return None


def brief_troubles(log: Sequence[str] = ()) -> None:
    """Let a script report such a trouble in its one sentence, and an interruption not at all; other errors as ever.

    log : file that takes what the script, and what it starts, writes to its output and its errors, as a sequence of
    one; nothing where there is none. The script's own errors are shown where they were before, too.
    """
    sys.excepthook = _report
    for file in log:
        shown = os.fdopen(os.dup(sys.stderr.fileno()), "w", encoding="utf-8", errors="replace")
        taken = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
            os.dup2(taken, stream.fileno())
        os.close(taken)
        sys.stderr = _Both(sys.stderr, shown)


class _Both(io.TextIOBase):
    """A stream that writes to two others."""

    def __init__(self, *streams: TextIO) -> None:
        self._streams = streams

    def write(self, text: str) -> int:
        for stream in self._streams:
            stream.write(text)
            stream.flush()
        return len(text)

    def fileno(self) -> int:
        return self._streams[0].fileno()

    def isatty(self) -> bool:
        return self._streams[1].isatty()


def _report(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if sentence := trouble(error):
        print(f"error: {sentence}", file=sys.stderr)
    elif not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
