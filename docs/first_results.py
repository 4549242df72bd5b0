"""Makes the results that ship with the program: `python -m docs.first_results`.

Computes the design that a new project begins with, a minute or two, and packs what the first page
shows of it into `workbench/pipeline/first_results.zip`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from ui.desk.session import DEFAULT_DESIGN
from workbench.door.results import evaluate
from workbench.pipeline.first_results import FILE, STAGES, pack_first
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project


def main(folder: Path) -> None:
    """Compute what is missing in a project, and pack it."""
    results = evaluate(load_design(DEFAULT_DESIGN), project=Project(folder))
    results.compute(*STAGES)
    calls = plan(results.design, results.case)
    size = pack_first(results.project.store, {stage: calls[stage].key for stage in STAGES})
    print(f"{FILE}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as folder:
            main(Path(folder))
