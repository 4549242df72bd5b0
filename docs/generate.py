"""Write the pages that are made from the program: `make docs`, or `python -m docs.generate`.

Each of these modules has a function `page` that gives its text; a test holds the files to them.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from docs import (
    generate_api,
    generate_command_line,
    generate_fields,
    generate_page_words,
    generate_parts,
    generate_scale,
    generate_speed,
    generate_trust,
)

FOLDER = Path(__file__).parent
PAGES: dict[str, Callable[[], str]] = {
    "api.md": generate_api.page,
    "command-line.md": generate_command_line.page,
    "fields.md": generate_fields.page,
    "page-words.md": generate_page_words.page,
    "parts.md": generate_parts.page,
    "scale.md": generate_scale.page,
    "speed.md": generate_speed.page,
    "trust.md": generate_trust.page,
}


def main() -> None:
    """Write all of them."""
    for name, page in PAGES.items():
        (FOLDER / name).write_text(page(), encoding="utf-8")
        print(f"docs/{name}")


if __name__ == "__main__":
    main()
