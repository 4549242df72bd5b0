"""The folder of the designer's own prices, by which the headline tells what the parts cost."""

from __future__ import annotations

from ui.desk.desk import Desk
from workbench.project.prices import Prices, read_prices, write_prices

SET, TAKE_BACK = "Set prices", "No prices"
LABELS = {
    "led": ("Price of an LED", "LEDs of the ring and lamps, with what drives them"),
    "camera": ("Price of a camera", "With its lens and board"),
    "gram": ("Price of silicone per g", "Cast elastomer, by its volume and density"),
    "base": ("Price of the rest", "What each sensor needs: housing, cables, printing of its mould"),
}
"""Label and hint of each price."""


class PricesFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        with gui.add_folder("My prices", expand_by_default=False):
            self.boxes = {
                name: gui.add_number(label, 0.0, min=0.0, hint=f"{hint}; in your own currency")
                for name, (label, hint) in LABELS.items()
            }
            hint = "Set prices keeps them in the project, and the headline tells the cost of the "
            hint += "parts; No prices takes it away"
            self.acts = gui.add_button_group("Prices", (SET, TAKE_BACK), hint=hint)
        self.acts.on_click(desk.guarded(lambda event: self._act()))
        self.show(read_prices(desk.session.project.folder))

    def show(self, prices: Prices | None) -> None:
        """Show prices, 0 where there are none."""
        for name, box in self.boxes.items():
            box.value = float(getattr(prices or Prices(), name))

    def _act(self) -> None:
        wanted = None
        if self.acts.value == SET:
            wanted = Prices(**{name: float(box.value) for name, box in self.boxes.items()})
        write_prices(self.desk.session.project.folder, wanted)
        self.show(wanted)
        self.desk.limited()
