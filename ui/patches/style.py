"""What the page's own style sheet mends of viser's; each rule says why.

viser takes no style sheet, but shows HTML, and a sheet in it holds for the whole page. A rule whose
part viser names otherwise one day holds for nothing: `tests/ui/test_looks.py` measures the page.
"""

from __future__ import annotations

from typing import Any

SHEET = """<style>
/* Names of widgets, hints, ends of sliders, notifications: viser's grey has 3 to 4 of contrast. */
:root[data-mantine-color-scheme="dark"] {
  --mantine-color-dimmed: #b4b4b4;
  --mantine-color-placeholder: #a6a6a6;
  --mantine-primary-color-light-color: #8ab4ff;
}
:root[data-mantine-color-scheme="light"] {
  --mantine-color-dimmed: #565d64;
  --mantine-color-placeholder: #666c72;
}
/* On a light page viser takes paler shades of brand and grey, on which white has 3.3 to 3.6. */
:root[data-mantine-color-scheme="light"] {
  --mantine-color-custom-6: #2563eb;
  --mantine-color-custom-7: #1d4fc4;
  --mantine-color-gray-filled: #5c636a;
}
.mantine-Slider-markLabel, .mantine-Notification-description { color: var(--mantine-color-dimmed); }
/* viser fades tabs that are not chosen, and the chosen one is too dark a blue on a dark page. */
[role="tab"] { opacity: 1 !important; }
:root[data-mantine-color-scheme="dark"] [role="tab"][aria-selected="true"] {
  color: #8ab4ff !important;
}
/* The row of tabs stays while a long page scrolls. viser's boxes around it hide what leaves them,
   which makes each of them a place of its own to stick to; cut off, they are not, but then would
   be as wide as the widest plot. In a narrow window, where the sheet lies over the 3D view,
   Chromium left a strip of the view blank. */
@media (min-width: 36em) {
  .mantine-ScrollArea-content div:has([role="tablist"]) {
    overflow: clip !important; min-width: 0 !important;
  }
  .mantine-ScrollArea-content [role="tablist"] {
    position: sticky !important; top: 0; z-index: 20; background: var(--mantine-color-body);
  }
}
/* What a button says takes a second line where it is too long for one; viser cuts it off. */
.mantine-Button-root { height: auto; min-height: var(--button-height); }
.mantine-Button-label { white-space: normal; line-height: 1.3; padding-block: 2px; }
/* Text may use the whole width: else the strip of stages takes two rows. */
[style*="max-width: 95%"] { max-width: 100% !important; }
/* A narrow window: the sheet at the bottom takes all of its width. */
@media (max-width: 36em) {
  [style*="width: 20em"] { width: 100% !important; }
  /* As a table it would grow with its plots, and they with it. */
  .mantine-ScrollArea-viewport > .mantine-ScrollArea-content,
  .mantine-ScrollArea-viewport > div { display: block !important; min-width: 0 !important; }
}
/* Small buttons above an image, and an image over the page: viser has neither. */
.image-tools { display: flex; gap: 4px; margin: 2px 10px 6px; font-size: 12px; }
.image-tools button {
  border: 1px solid var(--mantine-color-default-border); border-radius: 4px; padding: 2px 8px;
  background: var(--mantine-color-default); color: var(--mantine-color-text); cursor: pointer;
}
.image-tools button:focus-visible { outline: 2px solid var(--mantine-primary-color-filled); }
.zoom-image ~ div img[src^="blob:"], div:has(> .zoom-image) ~ div img[src^="blob:"] {
  width: 100%;
}
.whole-image {
  position: fixed; inset: 0; z-index: 9; padding-top: 8px; background: var(--mantine-color-body);
}
.whole-image .image-tools label { margin-left: 12px; color: var(--mantine-color-text); }
.whole-image .image-tools input { vertical-align: middle; width: 200px; }
.whole-frame { position: relative; margin: 0 auto; overflow: hidden; }
/* The 3D view while the image has the page, as high as the timeline beside it (BAR_PX of
   image_zoom.py); viser sizes it in its own style. */
.scene-in-the-corner {
  position: fixed !important; right: 12px; bottom: 12px; z-index: 11 !important;
  width: 26vw !important; height: 174px !important; border-radius: 6px; overflow: hidden;
  box-shadow: 0 0 0 1px var(--mantine-color-default-border);
}
@media (max-width: 36em) { .scene-in-the-corner { display: none; } }
.whole-frame img { display: block; width: 100%; }
/* The headline: figures side by side, each opening its reason over what stands below. */
.headline { position: relative; display: flex; gap: 3px; margin: 0 10px 8px; }
.headline details { flex: 1 1 auto; min-width: 0; }
.headline summary {
  display: grid; grid-template-columns: auto auto; list-style: none; cursor: pointer;
  padding: 3px 4px; border-radius: 4px; border: 1px solid var(--mantine-color-default-border);
  border-bottom: 3px solid var(--mantine-color-dimmed); color: var(--mantine-color-text);
}
.headline summary span {
  grid-column: 1 / 3; font-size: 10.5px; color: var(--mantine-color-dimmed); white-space: nowrap;
}
.headline summary b { font-size: 12px; font-weight: 600; white-space: nowrap; }
.headline summary i {
  font-size: 9px; font-style: normal; align-self: center; justify-self: end;
}
/* Read aloud, and not seen. */
.unseen { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
.headline details:not([open]) > div { display: none; }
.headline summary:focus-visible { outline: 2px solid var(--mantine-primary-color-filled); }
.headline .good summary { border-bottom-color: #30a46c; }
.headline .fair summary { border-bottom-color: #f5a623; }
.headline .poor summary { border-bottom-color: #e5484d; }
.headline .old summary b { font-weight: 400; font-style: italic; }
.headline details > div {
  position: absolute; left: 0; right: 0; top: 100%; z-index: 30; padding: 8px 10px;
  font-size: 13px; line-height: 1.45; border-radius: 4px; color: var(--mantine-color-text);
  background: var(--mantine-color-body); border: 1px solid var(--mantine-color-default-border);
}
.headline button {
  border: 0; padding: 0; background: none; cursor: pointer; text-decoration: underline;
  font: inherit; color: var(--mantine-color-anchor);
}
/* The cube that turns with the eye, over the 3D view. */
.view-cube { position: fixed; z-index: 1; width: 96px; height: 96px; pointer-events: none; }
.view-cube svg { position: absolute; inset: 0; overflow: visible; }
.view-cube line { stroke-width: 2; }
.view-cube text {
  font: 600 11px sans-serif; text-anchor: middle; dominant-baseline: middle; paint-order: stroke;
  stroke: var(--mantine-color-body); stroke-width: 4px;
}
.view-cube button {
  position: absolute; left: 28px; top: 28px; width: 40px; height: 40px; padding: 0;
  font: 600 10px sans-serif; cursor: pointer; pointer-events: auto; border-radius: 2px;
  color: var(--mantine-color-text); background: var(--mantine-color-body);
  border: 1px solid var(--mantine-color-dimmed);
}
.view-cube button:hover, .view-cube button:focus-visible {
  color: #fff; background: var(--mantine-primary-color-filled);
}
/* A closed folder is a heading with a line, not a box with nothing in it. */
.mantine-Paper-root:has(> .mantine-Paper-root > .tabler-icon-chevron-down) {
  border-width: 1px 0 0;
  border-radius: 0;
  padding-bottom: 0;
}
</style>"""


def mend(gui: Any) -> None:
    """Lay the style sheet into the page; it is seen nowhere itself."""
    gui.add_html(SHEET)
