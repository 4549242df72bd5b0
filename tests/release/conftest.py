"""The wheel, environments that hold nothing else of ours, and a press that one of them computed."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("workbench", "designs", "geometry", "sim", "ui")
BIN = "Scripts" if os.name == "nt" else "bin"
PRESS = (
    "run finger --indenter sphere --size-mm 6 --depth-mm 0.5 --frames 1 --grid-mm 0.8 "
    "--sources mpm,learned --out press"
)
LIGHT = ("optics.light_model=direct", "optics.camera.width_px=80", "optics.camera.height_px=60")
"""What makes the chain of `make demo` quick: no bake, and a small image."""
Run = Callable[..., str]


def clean_environment() -> dict[str, str]:
    """Without what would lend this repository, or a project, to a program."""
    hidden = {"PYTHONPATH", "PYTHONHOME", "WORKBENCH_PROJECT"}
    return {name: value for name, value in os.environ.items() if name not in hidden}


def ran(command: list[str | Path], folder: Path) -> str:
    """What a program prints, away from this repository."""
    words, env = [str(word) for word in command], clean_environment()
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(words)}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def tracked() -> list[str]:
    """The files of the packages in git, with those that are to be added."""
    command = ["git", "ls-files", "-z", "-co", "--exclude-standard", *PACKAGES]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.split("\0") if name]


def new_environment(home: Path) -> tuple[Path, Path]:
    """Folder of programs and folder of packages of a new environment."""
    ran([sys.executable, "-m", "venv", home], home)
    asked = "import sysconfig; print(sysconfig.get_path('purelib'))"
    return home / BIN, Path(ran([home / BIN / "python", "-c", asked], home).strip())


def install(wheel: Path, programs: Path, home: Path) -> None:
    """Install the wheel alone into an environment that has nothing of ours."""
    for package in PACKAGES:
        nothing = f"import importlib.util as u; print(u.find_spec('{package}'))"
        assert ran([programs / "python", "-c", nothing], home).strip() == "None", package
    options = ["--no-deps", "--no-index", "--force-reinstall", "--ignore-installed", "--quiet"]
    ran([programs / "python", "-m", "pip", "install", *options, wheel], home)


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of what is in git, built without asking any network."""
    folder = tmp_path_factory.mktemp("wheel")
    # A copy: setuptools keeps what earlier builds left in build/, and leaves its own there.
    for name in (*tracked(), "pyproject.toml", "README.md", "LICENSE", "NOTICE"):
        copy = folder / "source" / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes((ROOT / name).read_bytes())
    options = ["--no-deps", "--no-build-isolation", "--no-index", "--quiet"]
    ran([sys.executable, "-m", "pip", "wheel", *options, "-w", folder, folder / "source"], folder)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="session")
def held(wheel: Path) -> set[str]:
    """Names of the files in the wheel."""
    with zipfile.ZipFile(wheel) as file:
        return {name for name in file.namelist() if not name.endswith("/")}


@pytest.fixture(scope="session")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of an environment with the wheel, which is lent all other packages."""
    home = tmp_path_factory.mktemp("whole")
    programs, packages = new_environment(home)
    # A folder that a .pth names is searched, but no .pth in it is read: our editable install.
    lent = sysconfig.get_path("purelib")
    (packages / "lent.pth").write_text(f"{lent}\n", encoding="utf-8")
    install(wheel, programs, home)
    return programs


@pytest.fixture(scope="session")
def pressed(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that was empty, with `press` of a run and the project `.workbench` in it."""
    folder = tmp_path_factory.mktemp("pressed")
    quick = [word for field in LIGHT for word in ("--set", field)]
    ran([installed / "workbench", *PRESS.split(), *quick], folder)
    return folder
