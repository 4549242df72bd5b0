"""Write `page-words.md`: every string of the browser's page, to be read through in one go.

The page is laid out as for a browser, of a design with a lamp, two cameras, noise and markers, and
its messages are read; nothing is computed. That is done in a process of its own, which ends with
the server and its threads.
"""

from __future__ import annotations

import html
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.ui.inventory import MORE, Control, controls, laid_out
from workbench.edit.indenter_edit import gallery, gallery_heading
from workbench.live.job_words import WORDS
from workbench.live.lanes import WAITING
from workbench.planning.stage_table import STAGES
from workbench.proof.benchmarks.tab import Tab
from workbench.system.free_port import free_port
from workbench.view.object_words import EVERYDAY, HEADINGS

DESIGN = f"""
name = "mine"
family = "finger"{MORE}"""
ROOT = Path(__file__).parent.parent
HEAD = """# Words of the page

Made from the program by `make docs`: what stands on the browser's page before anything is computed,
page by page, from top to bottom. Choices are in words; the technical name of the one chosen, which
files and the command line know, stands in its hint.
"""
TAGS = re.compile(r"<style.*?</style>|<[^>]+>", re.DOTALL)
SEVERAL = 24
"""Choices of a list beyond which the rest is left out: they are names of parts or figures."""


def page() -> str:
    """The whole page."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name, "words.md")
        command = [sys.executable, "-m", "docs.generate_page_words", str(out)]
        subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
        return out.read_text(encoding="utf-8")


def laid_out_page(folder: Path) -> Tab:
    """A tab that has the whole page; its server runs until the process ends."""
    import viser

    from ui.app import build_desk
    from ui.desk.session import Session
    from ui.page.editor import Editor
    from workbench.live.conductor import Conductor
    from workbench.project.project import Project

    project = Project(folder)
    path = project.design_path("autosave")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(DESIGN, encoding="utf-8")
    session = Session(project)
    session.open(None)
    port = free_port()
    server = viser.ViserServer(host="127.0.0.1", port=port, verbose=False)
    conductor = Conductor(project.store, _Nobody())
    build_desk(server, session, conductor, Editor(server), fast=True, tour=False)
    return laid_out(Tab(f"http://127.0.0.1:{port}"))


class _Nobody:
    """Runs nothing: the page is only looked at."""

    def run(self, call: Any, monitor: Any) -> Any:
        raise RuntimeError(f"{call.stage} is not to be computed here")

    preview = run

    def close(self) -> None:
        """Nothing runs."""


def lines(tab: Tab, folder: Path) -> Iterator[str]:
    """The page as Markdown."""
    yield HEAD
    now: tuple[str, tuple[str, ...]] = ("", ())
    for control in controls(tab):
        if control.page != now[0]:
            yield f"\n## {control.page}\n"
        if (control.page, control.folders) != now and control.folders:
            yield f"\n**{' / '.join(control.folders)}**\n"
        now = control.page, control.folders
        yield from _of(control, folder)
    yield "\n## Texts\n"
    yield from (f"- {text}" for text in texts(tab, folder))
    yield "\n## Commands\n"
    yield from (f"- {name}" for name in sorted({c["label"] for c in tab.commands.values()}))
    yield "\n## While something runs\n"
    told = (*(stage.label for stage in STAGES.values()), *WORDS.values(), *WAITING.values())
    yield from (f"- {text}" for text in dict.fromkeys(told))
    yield "\n## Objects\n"
    for name in (*HEADINGS.values(), EVERYDAY):
        yield f"\n**{name}**\n"
        yield from (
            f"- {text}" for text, kind in gallery().items() if gallery_heading(kind) == name
        )


def _of(control: Control, folder: Path) -> Iterator[str]:
    yield f"- **{control.label}**: {control.hint.replace(str(folder), 'PROJECT')}"
    if control.options:
        left = len(control.options) - SEVERAL
        more = f"; {left} more" if left > 0 else ""
        yield f"  - {'; '.join(control.options[:SEVERAL])}{more}"


def texts(tab: Tab, folder: Path) -> list[str]:
    """What stands between the controls, each once, without its markup."""
    found = []
    for props in list(tab.widgets.values()):
        if props["kind"] in ("GuiMarkdownMessage", "GuiHtmlMessage"):
            raw = props.get("_markdown") or props.get("content") or ""
            if "<table" in raw:
                # Numbers of the design.
                continue
            text = html.unescape(TAGS.sub(" ", raw)).replace(str(folder), "PROJECT")
            found.append(re.sub(r"\s+", " ", text).strip())
    return [text for text in dict.fromkeys(found) if text]


def main(out: Path) -> None:
    """Write it to a file: viser prints lines of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        text = "\n".join(lines(laid_out_page(folder), folder))
    out.write_text(re.sub(r"\n{3,}", "\n\n", f"{text}\n"), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
