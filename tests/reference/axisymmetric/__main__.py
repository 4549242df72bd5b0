"""Write the record of limits: `python -m tests.reference.axisymmetric [--anew] [--workers 2]`.

Runs that the record has already are kept, unless it is to be written anew, or other code made it.
Takes about 20 minutes of two cores.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor, as_completed

from tests.reference.axisymmetric.cases import jobs, solve
from tests.reference.axisymmetric.record import load, run_row, same_run, save
from workbench.proof.validation.fem.fem_limits import RECORD


def main() -> None:
    """Solve what is missing; the record is saved after each run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--anew", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    head = RECORD.head()
    rows = [] if asked.anew else load()["runs"]
    wanted = [job for job in jobs() if not any(same_run(row, *job) for row in rows)]
    with ProcessPoolExecutor(asked.workers) as pool:
        futures = {pool.submit(solve, name, run): (name, run) for name, run in wanted}
        for future in as_completed(futures):
            name, run = futures[future]
            failure = future.exception()
            if failure is not None:
                print(name, run, repr(failure), flush=True)
                continue
            rows.append(run_row(name, run, future.result()))
            print(rows[-1], flush=True)
            save(rows, head)
    save(rows, head)


if __name__ == "__main__":
    main()
