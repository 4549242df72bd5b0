"""What a person would call broken on a page: boxes that overlap, text that is cut, faint text.

Measured in the page as it is laid out. Contrast is that of WCAG 2.2, criterion 1.4.3, of the text's
colour and the first opaque background among its ancestors; what is disabled is exempt.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

FOLDED = ".mantine-Paper-root > .mantine-Paper-root:has(> .tabler-icon-chevron-down):visible"
"""Title of a folder that is closed."""
TO_THE_TOP = "document.querySelectorAll('div').forEach((node) => { node.scrollTop = 0; })"
TABS = '[role="tab"]:visible'
NOTE = ".mantine-Notification-closeButton"


@dataclass(frozen=True, kw_only=True, order=True)
class Fault:
    """One thing that looks wrong."""

    kind: str
    """overlap, cut or contrast."""
    what: str
    """The text, or the two texts, as the page has them."""
    more: str
    """Pixels or ratio."""


MEASURE = """
() => {
  const shown = (box) => box.width > 1 && box.height > 1;
  // The part of a box that its scrolling or clipping ancestors leave.
  const clipped = (node, box) => {
    let [x0, y0, x1, y1] = [box.left, box.top, box.right, box.bottom];
    for (let up = node; up && up !== document.body; up = up.parentElement) {
      const style = getComputedStyle(up);
      if (style.visibility === "hidden" || style.display === "none" || style.opacity === "0")
        return null;
      const b = up.getBoundingClientRect();
      if (style.overflowX !== "visible") [x0, x1] = [Math.max(x0, b.left), Math.min(x1, b.right)];
      if (style.overflowY !== "visible") [y0, y1] = [Math.max(y0, b.top), Math.min(y1, b.bottom)];
      if (style.position === "fixed") break;
    }
    const part = {left: x0, top: y0, right: x1, bottom: y1, width: x1 - x0, height: y1 - y0};
    return shown(part) ? part : null;
  };
  const name = (node) => (node.innerText || node.value || node.getAttribute("aria-label")
    || node.getAttribute("role") || node.tagName).replace(/\\s+/g, " ").trim().slice(0, 60);
  // Canvas reads every notation of a colour; what is left of it lies over what is below.
  const pen = Object.assign(document.createElement("canvas"), {width: 1, height: 1})
    .getContext("2d", {willReadFrequently: true});
  const rgba = (colour) => {
    pen.clearRect(0, 0, 1, 1);
    pen.fillStyle = colour;
    pen.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = pen.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
  };
  const over = (top, below) =>
    [0, 1, 2].map((i) => top[3] * top[i] + (1 - top[3]) * below[i]).concat(1);
  const ground = (node) => {
    const layers = [];
    for (let up = node; up; up = up.parentElement) {
      const style = getComputedStyle(up);
      // Of a picture nothing is known; viser's gradients are the lines below tabs.
      if (style.backgroundImage.includes("url(")) return null;
      layers.unshift(rgba(style.backgroundColor));
      if (layers[0][3] === 1) return layers.reduce((below, top) => over(top, below));
    }
    return layers.reduce((below, top) => over(top, below), [255, 255, 255, 1]);
  };
  const light = (colour) => [0.2126, 0.7152, 0.0722].reduce((sum, share, i) => {
    const c = colour[i] / 255;
    return sum + share * (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  }, 0);
  const ratio = (node) => {
    const below = ground(node), colour = rgba(getComputedStyle(node).color);
    if (!below) return 21;
    for (let up = node; up; up = up.parentElement) colour[3] *= +getComputedStyle(up).opacity;
    const [high, low] = [light(over(colour, below)), light(below)].sort((a, b) => b - a);
    return (high + 0.05) / (low + 0.05);
  };
  const large = (style) => parseFloat(style.fontSize) >= (+style.fontWeight >= 700 ? 18.66 : 24);
  const items = [], cut = [], contrast = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode, parent = text.parentElement;
    if (!text.data.trim() || parent.closest("script, style, noscript")) continue;
    const range = document.createRange();
    range.selectNodeContents(text);
    const whole = range.getBoundingClientRect();
    const part = clipped(parent, whole);
    if (!part) continue;
    const words = text.data.replace(/\\s+/g, " ").trim().slice(0, 60);
    for (const line of range.getClientRects()) {
      const seen = clipped(parent, line);
      if (seen && !parent.closest(".view-cube")) items.push({node: parent, box: seen, text: words});
    }
    const lost = Math.max(part.left - whole.left, whole.right - part.right);
    if (lost > 1.5) cut.push([words, `${Math.round(lost)} px`]);
    const found = ratio(parent), least = large(getComputedStyle(parent)) ? 3 : 4.5;
    if (found < least && !parent.closest(":disabled, [data-disabled]"))
      contrast.push([words, `${found.toFixed(2)}, least ${least}`]);
  }
  for (const node of document.querySelectorAll("input, textarea")) {
    if (!clipped(node, node.getBoundingClientRect()) || node.type === "checkbox") continue;
    const lost = node.scrollWidth - node.clientWidth;
    if (lost > 1) cut.push([node.value || node.placeholder, `${lost} px`]);
  }
  for (const node of document.querySelectorAll("button, input, textarea, img, [role=slider]")) {
    const box = clipped(node, node.getBoundingClientRect());
    // Faces of the cube stand behind each other as faces of a cube do.
    if (box && !node.closest(".view-cube")) items.push({node, box, text: name(node)});
  }
  const stays = (node, below) => {
    const row = node.closest('[role="tablist"]');
    if (!row || getComputedStyle(row).position !== "sticky") return false;
    const dock = row.closest(".mantine-ScrollArea-content");
    return dock !== null && dock.contains(below) && !row.contains(below);
  };
  const overlaps = [];
  items.forEach((a, i) => items.slice(i + 1).forEach((b) => {
    if (a.node.contains(b.node) || b.node.contains(a.node)) return;
    const w = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left);
    const h = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
    if (w < 2 || h < 3) return;
    // The arrows and the cross of a box stand in it.
    const field = a.node.closest(".mantine-Input-wrapper, .mantine-Slider-root");
    if (field && field.contains(b.node)) return;
    // What has scrolled away below a row of tabs that stays is not seen.
    if (stays(a.node, b.node) || stays(b.node, a.node)) return;
    overlaps.push([`${a.text} / ${b.text}`, `${Math.round(w)} x ${Math.round(h)} px`]);
  }));
  return {overlap: overlaps, cut, contrast};
}
"""
DOCKS = "1 - document.querySelector('canvas').getBoundingClientRect().width / innerWidth"


def faults(page: Any) -> list[Fault]:
    """What looks wrong as the page stands, scrolled-out parts of docks apart."""
    found: dict[str, list[list[str]]] = page.evaluate(MEASURE)
    return sorted(
        {
            Fault(kind=kind, what=what, more=more)
            for kind, rows in found.items()
            for what, more in rows
        }
    )


def docks_share(page: Any) -> float:
    """Share of the width that the 3D view does not get."""
    return float(page.evaluate(DOCKS))


def places(page: Any) -> Iterator[str]:
    """Names of all tabs of all docks, each while it is on show."""
    for number, name in enumerate(page.locator(TABS).all_inner_texts()):
        quiet(page)
        page.locator(TABS).nth(number).click()
        # A tab's widgets are laid out after the click, and a fold opens slowly.
        page.wait_for_timeout(400)
        page.evaluate(TO_THE_TOP)
        # On a narrow page all docks are in one sheet that scrolls.
        page.locator(TABS).nth(number).scroll_into_view_if_needed()
        yield name.strip() or str(number)


def unfold(page: Any) -> None:
    """Open every closed folder, the outer ones first."""
    for _ in range(40):
        closed = page.locator(FOLDED)
        if not closed.count():
            break
        closed.first.click()
        page.wait_for_timeout(50)
    page.wait_for_timeout(300)


def quiet(page: Any) -> None:
    """Close notifications, which come over the view and go by themselves."""
    page.evaluate(f"document.querySelectorAll('{NOTE}').forEach((cross) => cross.click())")
