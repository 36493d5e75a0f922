"""What a run does, in one line of the terminal: rules done of all, what is at work, how long the rest takes.

`run.py` asks Snakemake for it where the output is a terminal. Warnings and errors are shown as ever; all that Snakemake
says stands in its log, which is named at the end.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import threading
import time
from collections import Counter
from pathlib import Path

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from dampbalance.project.progress import FOLDER, WIPE, draw, duration_in_words

DURATIONS = Path(".snakemake/durations.json")  # s, by rule: how long the jobs of earlier runs took
SHOWN = (LogEvent.JOB_ERROR, LogEvent.GROUP_ERROR, LogEvent.ERROR)


class LogHandler(LogHandlerBase):
    """Draws the line whenever Snakemake reports an event, and twice a second."""

    writes_to_stream = True
    writes_to_file = has_filter = has_formatter = needs_rulegraph = False

    def __post_init__(self) -> None:
        self.waiting: Counter[str] = Counter()  # jobs of each rule that have not begun
        self.running: dict[int, tuple[str, str, float]] = {}  # rule, its message, since when
        self.total = self.done = 0
        self.cores = 1
        self.took: dict[str, float] = {}
        if DURATIONS.is_file():
            self.took = json.loads(DURATIONS.read_text(encoding="utf-8"))
        self.drawing = threading.RLock()
        threading.Thread(target=self._keep_drawing, daemon=True).start()

    def emit(self, record) -> None:
        """Count what the record reports; print what it says if that is more than what the line shows."""
        with self.drawing:
            event = getattr(record, "event", None)
            getattr(self, f"_on_{event}", lambda record: None)(record)
            if (
                self.common_settings.dryrun
                or event in SHOWN
                or record.levelname in ("WARNING", "ERROR", "CRITICAL")
                or (event is None and record.pathname.endswith((".smk", "Snakefile")))
            ):
                print(f"{WIPE}{self.format(record)}", file=sys.stderr, flush=True)
            self._draw()

    def _on_run_info(self, record) -> None:
        stats = dict(record.stats)
        self.total = stats.pop("total", 0)
        self.waiting.update(stats)

    def _on_resources_info(self, record) -> None:
        self.cores = getattr(record, "cores", None) or self.cores

    def _on_job_info(self, record) -> None:
        self.waiting[record.rule_name] -= 1
        text = record.rule_msg or record.rule_name
        self.running[record.jobid] = record.rule_name, text, time.monotonic()

    def _on_job_finished(self, record) -> None:
        self.done += 1
        if record.job_id in self.running:
            name, _, began = self.running.pop(record.job_id)
            self.took[name] = time.monotonic() - began
        if self.done == self.total:
            DURATIONS.write_text(json.dumps(self.took), encoding="utf-8")

    def _on_job_error(self, record) -> None:
        self.running.pop(record.jobid, None)

    def _keep_drawing(self) -> None:
        while True:
            time.sleep(0.5)
            with self.drawing:
                self._draw()

    def _draw(self) -> None:
        if not self.running:
            if self.done:
                print(WIPE, end="", file=sys.stderr, flush=True)
            return
        texts = " · ".join(text for _, text, _ in self.running.values())
        left = self._seconds_left()
        rest = f", about {duration_in_words(left)} left" if left else ""
        draw(f"{self.done} of {self.total} rules done{rest}: {texts}", sys.stderr)

    def _seconds_left(self) -> float:
        """How long the rest takes: as jobs report, or else by how long their rule took before."""
        reported: dict[str, list[float]] = {}
        for file in Path(os.environ[FOLDER]).iterdir():
            with contextlib.suppress(
                OSError, ValueError
            ):  # it has just finished, or begun to write
                reported.setdefault(file.stem, []).append(float(file.read_text(encoding="utf-8")))
        if not self.took and not reported:
            return 0.0
        usual = sum(self.took.values()) / max(len(self.took), 1)
        now, rests = time.monotonic(), []
        for rule, _, began in self.running.values():
            if reported.get(rule):
                rests.append(reported[rule].pop())
            else:
                rests.append(max(self.took.get(rule, usual) - (now - began), 0.5))
        waiting = sum(n * self.took.get(rule, usual) for rule, n in self.waiting.items() if n > 0)
        return max(*rests, (sum(rests) + waiting) / self.cores)
