"""Whatever a design or a CAD file holds, the command line answers with a sentence, and soon.

Commands run through `workbench.cli.command_line`, each in a process of its own, up to the point
where the expensive stages would begin. `WORKBENCH_FUZZ_CASES` says how many of each kind; 300 is
what a release is tried with. `WORKBENCH_FUZZ_SEED` chooses others.
"""

from __future__ import annotations

import collections
import os
import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.forked import Ended, Forks
from tests.fuzzing import changed_design, changed_file, whole_files

CASES = int(os.environ.get("WORKBENCH_FUZZ_CASES", "20"))
SEED = int(os.environ.get("WORKBENCH_FUZZ_SEED", "16"))
HANG_S = 180.0
REFUSED_S = 10.0
"""Time within which what cannot be built is refused [s]; that of the processor is counted."""
MEMORY_MB = 4000.0
LONGEST_LINE = 600
CODES = (0, 1, 2, 3, 130)
HOUSE = ("geltip", "pad", "paw", "thumb", "trunk", "tentacle", "digitac")
FIELDS = ("case.press.depth_mm", "design.layers.elastomer_mm", "design.material.young_MPa")


def prepare() -> None:
    """Import what commands need, and stop them where minutes of computing would begin."""
    import build123d  # noqa: F401
    import manifold3d  # noqa: F401
    import scipy.sparse.csgraph
    import scipy.spatial  # noqa: F401

    import designs.family
    from workbench.pipeline import stage as stages
    from workbench.planning import plan as pipeline
    from workbench.planning import running

    designs.family.families()

    def cheap(self: pipeline.InlineRunner, call: stages.Call, monitor: Any) -> stages.Outcome:
        """Read files and build bodies; leave out what follows, and end where a press begins."""
        if call.stage in ("press", "mould"):
            raise SystemExit(0)
        if call.stage in ("intake", "build", "object"):
            return running.run(self.store, call, monitor)
        return stages.Outcome(stage=call.stage, key=call.key, cached=True, seconds=0.0)

    pipeline.InlineRunner.run = cheap


@pytest.fixture(scope="module")
def forks() -> Iterator[Forks]:
    """The process whose forks run the commands."""
    with Forks(prepare) as found:
        yield found


@pytest.fixture(scope="module")
def sound_designs() -> list[str]:
    """Every preset with all its fields written out, and a press with all of its own."""
    from workbench.project.design_toml import design_to_toml
    from workbench.project.named_designs import load_design
    from workbench.project.project import Project
    from workbench.project.state import case_table, fresh_state

    found = []
    for name in HOUSE:
        state = fresh_state(load_design(name))
        table = case_table(state.case, Project("unused"))
        found.append(design_to_toml(state.design, press_case=table))
    return found


@pytest.fixture(scope="module")
def sound_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Bodies and objects that can be used."""
    return whole_files(tmp_path_factory.mktemp("whole"))


def design_command(number: int, texts: list[str], folder: Path) -> list[str]:
    """A changed design and a command that reads it; every second one reads its press too."""
    rng = random.Random(f"{SEED} design {number}")
    (folder / "design.toml").write_bytes(changed_design(rng.choice(texts), rng))
    if number % 2:
        field, steps = rng.choice(FIELDS), ["--from", "0.3", "--to", "0.5", "--steps", "2"]
        words = ["sweep", "design.toml", "--field", field, *steps]
    else:
        words = [rng.choice(("run", "export")), "design.toml"]
    return [*words, *rng.choice(([], ["--json"]))]


def file_command(number: int, files: dict[str, bytes], folder: Path) -> list[str]:
    """A changed file and a command that reads it as a body or as an object."""
    rng = random.Random(f"{SEED} file {number}")
    body = rng.random() < 0.5
    role = "body" if body else "object"
    # A body is no OBJ, unless its ending is changed.
    known = [name for name in files if name.startswith(role) and not name == "body.obj"]
    name = rng.choice(known)
    content, ending = changed_file(files[name], f".{name.rpartition('.')[2]}", rng)
    (folder / f"file{ending}").write_bytes(content)
    if body:
        words = [rng.choice(("run", "export")), f"file{ending}"]
        words += rng.choice(([], [], ["--unit", "mm"]))
    else:
        words = ["run", rng.choice(("geltip", "pad")), "--indenter", f"file{ending}"]
        words += rng.choice(([], [], ["--size-mm", "6"], ["--turn-deg", "90,0,0"]))
    return [*words, *rng.choice(([], ["--json"]))]


def faults(ended: Ended, words: list[str]) -> list[str]:
    """What is wrong with how a command ended."""
    found = []
    if ended.code not in CODES:
        found.append(f"exit code {ended.code} after {ended.wall_s:.0f} s")
    if "Traceback" in ended.stderr or "this is a bug" in ended.stderr:
        found.append("a traceback")
    refused = "error: " in ended.stderr
    if ended.code in (2, 3) and words[0] != "sweep" and not refused:
        found.append("no message")
    # Every refusal but that of the parser of options names a remedy.
    if refused and "usage: " not in ended.stderr and not re.search(r"hint: \S", ended.stderr):
        found.append("no remedy")
    if ended.code in (2, 3) and ended.cpu_s > REFUSED_S:
        found.append(f"refused after {ended.cpu_s:.1f} s of the processor")
    longest = max(map(len, f"{ended.stderr}\n{ended.stdout}".split("\n")))
    if longest > LONGEST_LINE:
        found.append(f"a line of {longest} characters")
    if ended.memory_mb > MEMORY_MB:
        found.append(f"{ended.memory_mb:.0f} MB")
    return found


def run_all(forks: Forks, root: Path, command: Callable[[int, Path], list[str]]) -> None:
    """Run the cases, print the tally, and fail with what is wrong."""
    codes: collections.Counter[int] = collections.Counter()
    wrong, slowest_s = [], 0.0
    for number in range(CASES):
        folder = root / str(number)
        folder.mkdir()
        words = command(number, folder)
        # One project for all: what they share is built once.
        words += ["--out", "out", "--project", "../project"]
        ended = forks.run(words, folder, limit_s=HANG_S)
        codes[ended.code] += 1
        slowest_s = max(slowest_s, ended.cpu_s if ended.code else 0.0)
        found = faults(ended, words)
        if found:
            said = "\n".join(line[:300] for line in ended.stderr.split("\n")[-8:])
            wrong.append(f"case {number}, {' '.join(words)}: {', '.join(found)}\n{said}")
    print(f"{CASES} cases, exit codes {dict(codes)}, slowest refusal {slowest_s:.1f} s")
    assert not wrong, f"{len(wrong)} of {CASES}:\n" + "\n\n".join(wrong)


@pytest.mark.slow
def test_changed_designs_are_built_or_refused(
    forks: Forks, sound_designs: list[str], tmp_path: Path
) -> None:
    """No crash, no traceback, no other exit code; a message with a remedy, within 10 s."""
    run_all(forks, tmp_path, lambda n, to: design_command(n, sound_designs, to))


@pytest.mark.slow
def test_changed_files_are_read_or_refused(
    forks: Forks, sound_files: dict[str, bytes], tmp_path: Path
) -> None:
    """The same of STEP, STL and OBJ files, as bodies and as objects."""
    run_all(forks, tmp_path, lambda n, to: file_command(n, sound_files, to))
