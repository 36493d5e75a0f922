"""Run the scripts of rules as forks of one process that has imported what is slow to import.

A script of a rule spends a second on importing NumPy, pandas, Numba and matplotlib, and a rebuild runs thirty of them.
`run.py` has one process import them while Snakemake reads the workflow, and each script runs in a fork of it: a process
with its own memory, environment and exit status, that Snakemake waits for as it waits for a shell. The package itself
is not imported beforehand. Where processes cannot be forked safely (macOS, Windows), and for rules that a run deploys
in conda or containers, scripts are started as ever.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import importlib
import os
import pickle
import runpy
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

LIBRARIES = (
    *("jsonschema", "numba", "numba.np.arraymath", "pandas", "scipy.linalg", "scipy.optimize"),
    *("threadpoolctl", "pyarrow.parquet", "matplotlib.figure"),
    *("matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg"),
)


@functools.cache
def prepare() -> None:
    """Import the libraries, and have Numba learn what it knows: 0.15 s that each script with kernels would need."""
    for name in LIBRARIES:
        importlib.import_module(name)
    sys.modules["numba"].njit("void()")(lambda: None)


@contextlib.contextmanager
def scripts_as_forks() -> Iterator[None]:
    """Within this context Snakemake's jobs in this process run their scripts as forks."""
    if sys.platform != "linux":
        yield
        return
    from snakemake.script import PythonScript

    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    jobs, asked = socket.socketpair(type=socket.SOCK_SEQPACKET)
    if (server := os.fork()) == 0:
        jobs.close()
        _serve(asked)
    asked.close()
    started = PythonScript.execute_script

    asked_for: list[str] = []

    def execute_script(job: Any, file: str, edit: bool = False) -> None:
        asked_for.append(file)
        if edit or job.conda_env or job.container_img or job.env_modules:
            started(job, file, edit)
        else:
            _fork(jobs, job, file)

    PythonScript.execute_script = execute_script
    try:
        yield
    finally:
        PythonScript.execute_script = started
        jobs.close()
        if not asked_for:  # what it imports was in vain
            os.kill(server, signal.SIGKILL)
        os.waitpid(server, 0)


def _fork(jobs: socket.socket, job: Any, file: str) -> None:
    """Have the script of a job run, and wait for it."""
    from snakemake.benchmark import benchmarked

    here, there = socket.socketpair(type=socket.SOCK_SEQPACKET)
    with here:
        # in a file without a name: a message holds 200 kB, and an environment may be larger
        with there, open(os.memfd_create("job"), "w+b") as request:
            pickle.dump((file, dict(os.environ), job.threads), request)
            request.flush()
            socket.send_fds(jobs, [b"job"], [there.fileno(), request.fileno()])
        process = int(here.recv(16))
        measured = benchmarked(process, job.bench_record) if job.bench_record else None
        with measured or contextlib.nullcontext():
            status = int(here.recv(16) or -signal.SIGKILL)
    if status:
        raise subprocess.CalledProcessError(status, [sys.executable, file])


def _serve(asked: socket.socket) -> None:
    """Run each script that is asked for in a separate process, until nobody can ask any more."""
    # Meant for the scripts, and for who asks: it waits for a script that is yet to start.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # no threads that a fork would lose
    prepare()
    gc.freeze()  # a script searches for garbage among its own objects, not among those of the libraries
    running = 0
    while received := socket.recv_fds(asked, 16, 2)[1]:
        reply, request = received
        interrupted = signal.SIGINT in signal.sigpending()
        if os.fork() == 0:
            if (script := os.fork()) == 0:
                with open(request, "rb") as job:
                    job.seek(0)
                    _script(*pickle.load(job), interrupted)
            os.write(reply, str(script).encode())
            status = os.waitstatus_to_exitcode(os.waitpid(script, 0)[1])
            with contextlib.suppress(BrokenPipeError):
                os.write(reply, str(status).encode())
            os._exit(0)
        running += 1
        os.close(reply)
        os.close(request)
    for _ in range(running):
        os.wait()
    os._exit(0)


def _script(file: str, environment: dict[str, str], threads: int, interrupted: bool) -> None:
    """Run a script as Python itself would, and end."""
    from threadpoolctl import threadpool_limits

    status: Any = 0
    signal.signal(signal.SIGINT, signal.default_int_handler)
    rule = Path(file).name.removesuffix(".py").rpartition(".")[2]
    Path("/proc/self/comm").write_text(f"job {rule}"[:15], encoding="utf-8")  # for ps and top
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = [file]
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        if interrupted:
            raise KeyboardInterrupt
        with threadpool_limits(threads):  # for a shell, Snakemake states it in variables
            runpy.run_path(file, run_name="__main__")
    except SystemExit as end:  # a status, or words and 1
        status = end.code or 0
        if not isinstance(status, int):
            print(status, file=sys.stderr)
            status = 1
    except BaseException:
        sys.excepthook(*sys.exc_info())
        status = 1
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(status)
