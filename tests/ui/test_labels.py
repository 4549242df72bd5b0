"""Every control has a name that a person reads and a test finds, a unit where it has one, a hint.

This is what accessibility viser leaves to us: a screen reader speaks the labels.
"""

from __future__ import annotations

import contextlib
import re
from collections import Counter
from collections.abc import Iterator
from functools import partial
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.inventory import HEADER, MORE, Control, controls, laid_out
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import COARSE, button, open_page, tab, wait_until
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

UNITS = "mm N deg MPa % px e dB".split()
DIMENSIONLESS = set(
    "LEDs,Frames,Vents,Steps,Frame,Samples,Photons,Light nodes,Light seed,Noise seed,Stroke frames,"
    # Ratios, shares and coefficients.
    "Tip ratio,Poisson,Friction,Albedo,Gloss,Roughness,Phong diffuse,Phong specular,"
    "Phong exponent,Ink,Vignetting,Gamma,Region error,Explode,Exposure,"
    "LED power,LED factor,Lamp power,Ambient power,Gain rgb,Fall-off k,"
    # Directions of any length.
    "Shines along,Lies along,"
    # A scale of its own, and numbers in the unit of the parameter that is chosen above them.
    "Shore A,From,To,Lowest,Highest,Value,Good from,Poor from,"
    # Prices are in the designer's own currency.
    "Price of an LED,Price of a camera,Price of silicone per g,Price of the rest,"
    # A count.
    "Designs to compute".split(",")
)
NUMBERS = ("Slider", "MultiSlider", "Number", "Vector2", "Vector3")
PARTS_S = 240


@pytest.fixture(scope="module")
def server(warm: WarmStart, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server with a lamp, two cameras, noise and markers."""
    project = tmp_path_factory.mktemp("labels") / "project"
    (project / "designs").mkdir(parents=True)
    head, rest = COARSE.split("[press_case.press]")
    text = f"{head}{MORE}[press_case.press]{rest}"
    (project / "designs" / "autosave.toml").write_text(text)
    with Server(project, warm=warm) as running:
        yield running


def listed(server: Server) -> list[Control]:
    """All controls as they stand, but for the one that only the tab which lists them may have:
    it follows while another one edits."""
    with Tab(server.url) as looking:
        return [one for one in controls(laid_out(looking)) if one.label != "Edit here"]


def test_every_control_has_a_name_a_unit_and_a_hint(server: Server) -> None:
    """Names are unique on a page; numbers have a unit or are known to have none."""
    found = listed(server)
    assert len(found) > 200, "the walk has found few controls"
    assert [c for c in found if not c.label.strip()] == []
    assert [f"{c.page}: {c.label}" for c in found if not c.hint.strip()] == []
    named = Counter((c.page, c.label) for c in found)
    assert [name for name, count in named.items() if count > 1] == []
    bare = [c for c in found if c.kind in NUMBERS and c.label not in DIMENSIONLESS]
    assert [f"{c.page}: {c.label}" for c in bare if c.label.split()[-1] not in UNITS] == []


def test_every_control_on_show_is_reached_by_its_name(server: Server, page: Any) -> None:
    """Pressed, with parts made: each tab is visited, each folder opened, each control found."""
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    tab(page, "Make").click()
    button(page, "Make parts").click()
    wait_until(lambda: button(page, "Download part STL").count(), PARTS_S, "the parts are made")
    found = [control for control in listed(server) if control.visible]
    assert {"Show parts", "All mould parts", "Lamp colour", "Camera"} <= {c.label for c in found}
    named = Counter((c.page, c.label) for c in found)
    assert [name for name, count in named.items() if count > 1] == []
    missing = []
    for name in dict.fromkeys(control.page for control in found):
        here = [control for control in found if control.page == name]
        if name != HEADER:
            tab(page, name).click()
        unfold(page, here)
        with contextlib.suppress(AssertionError):
            # Folders open slowly where there is no GPU.
            wait_until(partial(found_all, page, here), 15, "all controls are there")
        missing += [f"{name}: {label}" for label in lost(page, here)]
    assert missing == []


def unfold(page: Any, here: list[Control]) -> None:
    """Open the closed folders of a page, the outer ones first."""
    for folder in dict.fromkeys(name for control in here for name in control.closed):
        title = page.get_by_text(folder, exact=True).locator("visible=true").first
        title.scroll_into_view_if_needed()
        title.click()
        page.wait_for_timeout(300)


def found_all(page: Any, here: list[Control]) -> bool:
    """Whether no control is lost."""
    return not lost(page, here)


def lost(page: Any, here: list[Control]) -> list[str]:
    """Controls that cannot be found by their label, or by the text on them."""
    texts = page.locator("label:visible, button:visible").all_inner_texts()
    seen = {re.sub(r"\s+", " ", text).strip() for text in texts}
    return [control.label for control in here if control.label not in seen]
