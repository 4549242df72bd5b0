"""Lines for people and programs: answers on stdout, everything else on stderr."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any, TextIO

from workbench.core.base.monitor import seconds_left
from workbench.core.base.units import human_seconds


def say(text: object) -> None:
    """Print a line of the answer; a reader that went away (`| head -1`) changes nothing else."""
    _write(sys.stdout, f"{text}\n")


def complain(text: str, *, end: str = "\n") -> None:
    """Print a line for people beside the answer."""
    _write(sys.stderr, text + end)


def _write(stream: TextIO, text: str) -> None:
    try:
        try:
            stream.write(text)
        except UnicodeEncodeError:
            # A Windows console may lack the letters for mm2 and degrees.
            stream.write(text.encode(stream.encoding, "replace").decode(stream.encoding))
        stream.flush()
    except BrokenPipeError:
        # What is still buffered would raise again when the interpreter flushes it at exit.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


class Progress:
    """Prints progress of stages: JSON lines, or one line of text per finished stage."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.stage = ""
        self.started = 0.0
        self.shown = 0.0

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        """Show how far a stage is, at most five times a second."""
        now = time.monotonic()
        if stage != self.stage:
            self.stage, self.started, self.shown = stage, now, 0.0
        if now - self.shown < 0.2:
            return
        self.shown = now
        elapsed = now - self.started
        eta_s = seconds_left(elapsed, fraction)
        if self.as_json:
            line = {"stage": stage, "fraction": fraction, "note": note, "eta_s": eta_s}
            say(json.dumps(line))
        elif sys.stderr.isatty():
            left = f", {human_seconds(eta_s)} left" if eta_s is not None else ""
            complain(f"\r\x1b[K{stage} {100 * fraction:.0f} %{left} {note}", end="")

    def done(self, outcome: Any) -> None:
        """Show that a stage has ended."""
        if self.as_json:
            line = {
                "stage": outcome.stage,
                "key": outcome.key,
                "cached": outcome.cached,
                "seconds": outcome.seconds,
            }
            say(json.dumps(line))
        else:
            state = "cached" if outcome.cached else human_seconds(outcome.seconds)
            end = "\r\x1b[K" if sys.stderr.isatty() else ""
            complain(f"{end}{outcome.stage:8} {outcome.key[:12]}  {state}")
