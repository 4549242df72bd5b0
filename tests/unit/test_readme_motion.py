"""The README's example of motion runs."""

import re
from pathlib import Path

from workbench.core.press import Press

README = (Path(__file__).parents[2] / "README.md").read_text()


def test_example_of_the_readme_makes_presses() -> None:
    """10 + 3 x 10 frames, 5 frames, and 85 + 85 x 10 x 8 presses of Algorithm 1."""
    (code,) = re.findall(r"^```python\n(from workbench\.algorithms.*?)^```$", README, re.M | re.S)
    names: dict[str, object] = {}
    exec(code, names)
    rolled, timed, presses = names["rolled"], names["timed"], names["presses"]
    assert isinstance(rolled, Press)
    assert isinstance(timed, Press)
    assert isinstance(presses, list)
    assert (rolled.frame_count, timed.frame_count, len(presses)) == (40, 5, 85 + 6800)
