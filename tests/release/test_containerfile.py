"""The container file, as far as it can be followed without a container: copies, builds, starts."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.release.conftest import PACKAGES, ROOT, ran, tracked
from workbench.cli.command_line import parser
from workbench.core.base.version import VERSION

FILE = ROOT / "Containerfile"


def instructions() -> Iterator[tuple[str, list[str]]]:
    """Each instruction with its words; lines that go on are one."""
    text = FILE.read_text(encoding="utf-8").replace("\\\n", " ")
    for line in text.splitlines():
        if line and not line.startswith("#"):
            name, *words = line.split()
            yield name, words


def words_of(name: str) -> list[list[str]]:
    """The words of every instruction of a name."""
    return [words for found, words in instructions() if found == name]


def test_what_it_copies_is_there_and_is_enough(tmp_path: Path) -> None:
    """All five packages, the lock, and what pyproject.toml names; from git, not from this disk."""
    copied = {source for *sources, _ in words_of("COPY") for source in sources}
    assert copied >= {*PACKAGES, "requirements.lock", "pyproject.toml", "README.md"}
    for source in copied:
        assert (ROOT / source).exists(), source
    for *sources, target in words_of("COPY"):
        assert target == "./" or sources == [target]


def test_it_starts_what_the_command_line_takes() -> None:
    """CMD by the real parser: served to the outside, on the port that is exposed."""
    (command,) = words_of("CMD")
    program, *words = json.loads(" ".join(command))
    options = parser().parse_args(words)
    assert program == "workbench"
    assert (options.command, options.host) == ("serve", "0.0.0.0")
    assert words_of("EXPOSE") == [[str(options.port)]]
    head = FILE.read_text(encoding="utf-8").split("FROM")[0]
    assert f":{options.port}:{options.port} " in head


def test_its_python_is_one_that_the_package_takes() -> None:
    """The base image names a minor version between the limits of pyproject.toml."""
    ((image,),) = words_of("FROM")
    minor = int(image.removeprefix("python:3.").partition("-")[0])
    assert f'requires-python = ">=3.{11},<3.{14}"' in (ROOT / "pyproject.toml").read_text("utf-8")
    assert 11 <= minor < 14


@pytest.mark.slow
def test_what_it_copies_can_be_installed(tmp_path: Path) -> None:
    """Its last RUN, in a folder that holds what COPY copies, from git: the version is there."""
    files = [
        *tracked(),
        *(f for words in words_of("COPY") for f in words[:-1] if (ROOT / f).is_file()),
    ]
    for name in files:
        if name.split("/")[0] in {source for words in words_of("COPY") for source in words[:-1]}:
            copy = tmp_path / "source" / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, copy)
    *_, last = words_of("RUN")
    assert last == "pip install --no-cache-dir --no-deps .".split()
    offline = ["--no-build-isolation", "--no-index", "--quiet", "--target", tmp_path / "there"]
    ran([sys.executable, "-m", *last, *offline], tmp_path / "source")
    code = "import workbench; print(workbench.__version__, workbench.__file__)"
    said = ran(
        [sys.executable, "-P", "-c", f"import sys; sys.path[:0] = ['there']; {code}"], tmp_path
    )
    assert said.split()[0] == VERSION
    assert (tmp_path / "there" / "designs" / "presets" / "geltip.toml").exists()
