"""The command line, as `dampbalance` and as `python -m dampbalance`.

Ctrl-C ends it with one line at any time, and a reader of its output that stops early, as `head` does, without any.
Most of that time goes into imports, and so they are made where an interruption is caught.
"""

import os
import sys


def main() -> int:
    """Run one command and return its exit code: 130 where it was interrupted, 141 where nobody reads its output."""
    try:
        from .commands.main import main as run

        try:
            return run()
        finally:
            sys.stdout.flush()
    except KeyboardInterrupt as stop:
        notes = getattr(stop, "__notes__", ())
        print(f"dampbalance: stopped; {'; '.join(notes) or 'nothing written'}", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        return 141


if __name__ == "__main__":
    raise SystemExit(main())
