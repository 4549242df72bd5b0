"""The command line: what may be typed, and what it runs."""

from __future__ import annotations

from collections.abc import Sequence


def entry() -> int:
    """Entry point of the `workbench` command; returns the exit code."""
    from workbench.cli.command_line import entry as run

    return run()


def main(words: Sequence[str] | None = None) -> int:
    """Do in this process what the words say, by default those typed; returns the exit code."""
    from workbench.cli.command_line import main as run

    return run(words)
