"""The command line, as `dampbalance` and as `python -m dampbalance`: Ctrl-C stops it with one line at any time.

Most of that time goes into imports, and so they are made where an interruption is caught.
"""

import sys


def main() -> int:
    """Run one command and return its exit code, 130 where it was interrupted."""
    try:
        from .commands.main import main as run

        return run()
    except KeyboardInterrupt as stop:
        notes = getattr(stop, "__notes__", ())
        print(f"dampbalance: stopped; {'; '.join(notes) or 'nothing written'}", file=sys.stderr)
        return 130


if __name__ == "__main__":
    raise SystemExit(main())
