"""kill -9 in the middle of work: what was kept is there, whole, and nothing runs on.

`WORKBENCH_KILLS` says at how many moments; 30 is what a release is tried with.
`WORKBENCH_KILL_SEED` chooses others.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import random
import re
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from tests.ui.conftest import Server
from tests.ui.widgets import coarse_project
from workbench.pipeline.store import DAMAGED, Store
from workbench.project.project import Project
from workbench.project.saved_designs import open_design, saved_names
from workbench.project.state import read_state
from workbench.proof.benchmarks.tab import Tab
from workbench.variants.sweep_files import list_sweeps, load_sweep
from workbench.variants.variant_files import list_variants
from workbench.variants.variants import load_variant

pytestmark = [pytest.mark.ui, pytest.mark.slow]

KILLS = int(os.environ.get("WORKBENCH_KILLS", "2"))
SEED = int(os.environ.get("WORKBENCH_KILL_SEED", "9"))
MARK = "WORKBENCH_KILL_TEST"
"""Variable by which all that a server started is known."""
LONGEST_S = 25.0
"""Work before the kill [s]."""
GONE_S = 10.0
"""Time that processes have to end after it [s]."""
SAVED_S = 5.0
"""Time after an edit by which a busy machine has autosaved it [s]."""
FIRST_S = 240.0
"""Time for the first press where processors are shared."""
LENGTH, DEPTH = "Straight length mm", "Depth mm"


@dataclass
class Promised:
    """What the server said was kept, and what it was asked for."""

    lengths: list[tuple[float, float]] = field(default_factory=list)
    """Time and value of each edit [s, mm]."""
    designs: dict[str, float] = field(default_factory=dict)
    """Straight length of each design that was saved [mm]."""
    variants: dict[str, float] = field(default_factory=dict)
    sweeps: int = 0
    results: dict[Path, str] = field(default_factory=dict)
    """Digest of the files of each result that was whole."""


class Designer:
    """Works in one tab, at random but the same for the same seed, until the server is gone."""

    def __init__(self, tab: Tab, rng: random.Random, round_: int, promised: Promised) -> None:
        self.tab, self.rng, self.round, self.promised = tab, rng, round_, promised
        self.names = iter(range(1000))
        self.done: list[str] = []

    def work(self) -> None:
        """Act until the connection breaks."""
        acts: list[Callable[[], None]] = [
            *(self.edit, self.edit, self.press, self.press, self.render, self.parts),
            *(self.save, self.save, self.variant, self.variant, self.sweep, self.download),
        ]
        while not self.tab.closed:
            act = self.rng.choice(acts)
            self.done.append(act.__name__)
            # What is refused, or not to be had yet, is part of a designer's day; so is the kill.
            with contextlib.suppress(TimeoutError, ConnectionClosed):
                act()
            self.pause(self.rng.uniform(0.0, 3.0))

    def pause(self, seconds: float) -> None:
        with contextlib.suppress(TimeoutError):
            self.tab.wait(lambda: self.tab.closed, seconds, "a pause")

    def heard(self, words: str, seconds: float) -> None:
        self.tab.wait(lambda: self.tab.closed or self.tab.has_seen(words), seconds, words)
        if not self.tab.has_seen(words):
            raise TimeoutError(words)

    def edit(self) -> None:
        value = float(self.rng.randint(150, 300)) / 10
        self.promised.lengths.append((time.monotonic(), value))
        self.tab.set(LENGTH, value)

    def press(self) -> None:
        self.tab.set(DEPTH, self.rng.randint(30, 70) / 100)
        self.tab.click("Run press")

    def render(self) -> None:
        self.tab.set("LED height mm", self.rng.choice((3.0, 4.0, 5.0)))
        self.tab.click("Render image")

    def parts(self) -> None:
        self.tab.click("Make parts")

    def save(self) -> None:
        name = f"design {self.round} {next(self.names)}"
        self.tab.set("Name", name)
        # The name is read a moment after the last letter.
        self.pause(2.0)
        length = self.promised.lengths[-1][1]
        self.tab.trigger("Save design")
        self.heard(f"{name}: design and press", 5.0)
        self.promised.designs[name] = length

    def variant(self) -> None:
        name = f"variant {self.round} {next(self.names)}"
        self.tab.set("Variant name", name)
        length = self.promised.lengths[-1][1]
        self.tab.click("Save variant")
        self.heard(f"variant {name} saved", 5.0)
        self.promised.variants[name] = length

    def sweep(self) -> None:
        field = next(
            (o for o in self.tab.widgets[self.tab.uuid("Parameter")]["options"] if "epth" in o), ""
        )
        self.tab.set("Parameter", field)
        self.tab.set("From", 0.3)
        self.tab.set("To", self.rng.randint(4, 6) / 10)
        self.tab.set("Steps", 2)
        self.tab.click("Run sweep")
        self.promised.sweeps += 1

    def download(self) -> None:
        self.tab.click(
            self.rng.choice(("Download design", "Download all (zip)", "Save scene (HTML)"))
        )


def marked(mark: str) -> set[int]:
    """Processes that inherited the mark, the dead that wait to be noticed left out."""
    found = set()
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if f"{MARK}={mark}".encode() in (folder / "environ").read_bytes().split(b"\0"):
                found.add(int(folder.name))
    return found


def shown(tab: Tab, words: str) -> bool:
    """Whether a line of text on the page has these words."""
    return any(words in str(widget.get("_markdown", "")) for widget in list(tab.widgets.values()))


def running(tab: Tab, store: Path) -> str:
    """What the page said was running, and what was being written."""
    texts = [str(w.get("_markdown", w.get("content", ""))) for w in list(tab.widgets.values())]
    found = {m[1] for t in texts for m in re.finditer(r"([A-Z][a-z ]+) \d+ %", t)}
    found |= {m[1] for t in texts for m in re.finditer(r"([A-Z][a-z]+)(?: |&nbsp;)▶", t)}
    found |= {f"writing {part.parent.name}" for part in store.glob("*/.part-*")}
    return ", ".join(sorted(found)) or "nothing"


def results(store: Path) -> set[Path]:
    """Folders of results that have their names."""
    return {
        meta.parent
        for meta in store.glob("*/*/meta.json")
        if meta.parent.name[0] != "." and meta.parent.parent.name != DAMAGED
    }


def digest(folder: Path) -> str:
    """Of all files of a result."""
    whole = hashlib.sha256()
    for file in sorted(folder.iterdir()):
        whole.update(file.name.encode() + file.read_bytes())
    return whole.hexdigest()


def wait_gone(mark: str) -> float:
    """Seconds until no process with the mark is left."""
    killed = time.monotonic()
    while left := marked(mark):
        assert time.monotonic() - killed < GONE_S, f"still there: {left}"
        time.sleep(0.1)
    return time.monotonic() - killed


def check_files(root: Path, promised: Promised, killed_s: float) -> float:
    """Designs, variants, sweeps and results as they lie; returns the autosaved length [mm]."""
    project = Project(root)
    text = (root / "designs" / "autosave.toml").read_text(encoding="utf-8")
    length = read_state(text, project, source="autosave").design.shape["cylinder_mm"]
    settled = [n for n, (when, _) in enumerate(promised.lengths) if killed_s - when > SAVED_S]
    # The newest edit that had time to be saved, or any after it.
    first = settled[-1] if settled else 0
    assert length in [value for _, value in promised.lengths[first:]]
    designs = {n: open_design(project, n).design.shape for n in saved_names(project)}
    for name, value in promised.designs.items():
        assert designs[name]["cylinder_mm"] == value, name
    variants = {n: load_variant(project, n).state.design.shape for n in list_variants(project)}
    for name, value in promised.variants.items():
        assert variants[name]["cylinder_mm"] == value, name
    for name in list_sweeps(project):
        load_sweep(project, name)
    return length


def check_store(root: Path, promised: Promised) -> None:
    """Every result loads and is what it was; new ones are added to what is promised."""
    told: list[str] = []
    store = Store(root / "store")
    store.on_message = told.append
    found = results(store.root)
    for folder in found:
        stage, key = folder.parent.name, folder.name
        assert store.has(stage, key), folder
        store.load(stage, key)
        promised.results.setdefault(folder, digest(folder))
    assert told == []
    assert not (store.root / DAMAGED).exists()
    assert not set(promised.results) - found


def check_page(server: Server, promised: Promised, length: float) -> None:
    """The page begins where the killed one was, and lists what was kept."""
    with Tab(server.url) as tab:
        tab.wait(lambda: tab.value(LENGTH) == length, 20, "the length is back")

        def offered(label: str) -> set[str]:
            return set(tab.widgets[tab.uuid(label)]["options"])

        tab.wait(lambda: set(promised.designs) <= offered("Saved design"), 20, "designs are listed")
        names = set(promised.variants)
        tab.wait(lambda: names <= offered("Chosen variant"), 20, "variants are listed")
        assert tab.find("Edit here") == tab.find("Take over") == ""


def test_kill_9_loses_nothing_that_was_kept(
    tmp_path: Path, start_server: Callable[..., Server], monkeypatch: pytest.MonkeyPatch
) -> None:
    """At each moment: no process after 10 s, the last saves whole, every result loads."""
    root, rng, promised = coarse_project(tmp_path), random.Random(SEED), Promised()

    def start(number: int) -> tuple[Server, str]:
        mark = f"{os.getpid()}-{number}"
        monkeypatch.setenv(MARK, mark)
        server = start_server(root, cold=True)
        monkeypatch.delenv(MARK)
        return server, mark

    slowest_s = 0.0
    server, mark = start(0)
    for number in range(KILLS):
        with Tab(server.url) as tab:
            promised.lengths = [(time.monotonic(), float(tab.value(LENGTH)))]
            # Most moments are those of work, some those of a start; at first an image is finished.
            if number == 0:
                tab.wait(lambda: shown(tab, "Image&nbsp;✓"), FIRST_S, "the example is pressed")
            elif rng.random() < 0.8:
                tab.wait(lambda: shown(tab, "Shape&nbsp;✓"), FIRST_S, "the shape is there")
            designer = Designer(tab, random.Random(rng.random()), number, promised)
            thread = threading.Thread(target=designer.work, daemon=True)
            thread.start()
            time.sleep(rng.uniform(0.5, LONGEST_S))
            before, what = results(root / "store"), running(tab, root / "store")
            members, killed_s = marked(mark), time.monotonic()
            server.kill()
            gone_s = wait_gone(mark)
            slowest_s = max(slowest_s, gone_s)
            thread.join(20.0)
            assert not thread.is_alive()
        print(
            f"kill {number}: {what}; after {', '.join(designer.done)}; {len(members)} processes "
            f"gone in {gone_s:.1f} s; {len(before)} results",
            flush=True,
        )
        assert before <= results(root / "store")
        length = check_files(root, promised, killed_s)
        check_store(root, promised)
        server, mark = start(number + 1)
        check_page(server, promised, length)
        # What a dead writer left is swept away at the start, and none of it has been read.
        dead = {str(pid) for pid in members}
        left = [re.split("[-@]", part.name)[1] for part in root.rglob(".part-*")]
        assert not dead & set(left)
        assert "Traceback" not in server.log.read_text()
    for folder, known in promised.results.items():
        assert digest(folder) == known, folder
    print(
        f"{KILLS} kills: {len(promised.designs)} designs, {len(promised.variants)} variants, "
        f"{promised.sweeps} sweeps asked for, {len(promised.results)} results checked; "
        f"no process after {slowest_s:.1f} s"
    )
