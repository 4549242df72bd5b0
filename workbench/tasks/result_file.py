"""What a task leaves: `result.json` with every number, and `report.html` for people."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

from workbench.core.base.version import VERSION
from workbench.system.record import code_digest
from workbench.system.whole_files import write_atomically
from workbench.tasks.run import Result

RESULT, REPORT = "result.json", "report.html"
FILES = (RESULT, REPORT)
SOURCES = ("workbench.tasks",)
"""Code that the numbers rest on, with what it imports."""


def result_table(result: Result) -> dict[str, Any]:
    """All numbers, as JSON holds them."""
    return {
        "task": result.plan.task,
        "design": result.design.name,
        "size": result.plan.size.value,
        "network": result.plan.net.value,
        "rows": [dataclasses.asdict(row) for test in result.tests for row in test.rows],
        "details": {
            **result.details,
            "tests": {test.test.value: test.details for test in result.tests},
            "program": VERSION,
            "code": code_digest(SOURCES),
        },
    }


def write_result(out: Path, result: Result) -> dict[str, Any]:
    """Write both files; returns what stands in the first.

    Raises:
        StoreError: If the folder cannot be written.
    """
    from workbench.tasks.report import report_page

    table = result_table(result)
    write_atomically(out / REPORT, report_page(result, table).encode())
    write_atomically(out / RESULT, json.dumps(table, indent=1, allow_nan=False).encode())
    return table
