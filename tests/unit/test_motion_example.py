"""The example of motion in docs/contact.md runs."""

import re
from pathlib import Path

from workbench.core.press.press import Press

PAGE = (Path(__file__).parents[2] / "docs" / "contact.md").read_text()


def test_example_of_the_page_makes_presses() -> None:
    """10 + 3 x 10 frames, 5 frames, and 85 + 85 x 10 x 8 presses of Algorithm 1."""
    (code,) = re.findall(r"^```python\n([^`]*wb\.Trajectory.*?)^```$", PAGE, re.M | re.S)
    names: dict[str, object] = {}
    exec(code, names)
    rolled, timed, presses = names["rolled"], names["timed"], names["presses"]
    assert isinstance(rolled, Press)
    assert isinstance(timed, Press)
    assert isinstance(presses, list)
    assert (rolled.frame_count, timed.frame_count, len(presses)) == (40, 5, 85 + 6800)
