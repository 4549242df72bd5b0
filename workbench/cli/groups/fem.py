"""`workbench fem`: solve a press by finite elements, or have another program check it.

`export` writes the case as a deck of CalculiX or Abaqus that carries design and press; `import`
reads that program's results and prints its forces beside ours, frame by frame.
"""

from __future__ import annotations

from workbench.cli.command import Group

GROUP = Group(
    place=12, help="Solve presses by finite elements, or have another program check them."
)
