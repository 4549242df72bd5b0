"""One self-contained HTML page: style, figures as data, simple tables; used by all reports.

No page loads anything from elsewhere, and none runs a script. What comes from a designer is
escaped here or by whoever builds the body.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em}
body{color:#1b1f24}
h1{font-size:1.6em;margin-bottom:0}h2{font-size:1.15em;margin-top:1.8em}
.images{display:flex;flex-wrap:wrap;gap:10px}figure{margin:0}figcaption{font-size:.85em;color:#555}
img{max-width:100%;border-radius:4px}table{border-collapse:collapse;font-size:.92em}
td,th{padding:2px 14px 2px 0;text-align:left;border-bottom:1px solid #e3e6ea}
td.n{text-align:right;font-variant-numeric:tabular-nums}
@media print{body{margin:0;max-width:none;font-size:12px}figure,tr,svg{break-inside:avoid}
h2{break-after:avoid}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
"""
JPEG_QUALITY = 90


def page(title: str, body: str) -> str:
    """A whole page; the title is text, the body HTML."""
    return (
        f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style><body>{body}</body></html>"
    )


def figure(png: bytes, caption: str, *, width: int = 640) -> str:
    """A PNG file with its caption, which is text."""
    return _figure("image/png", png, caption, width)


def photograph(rgb: np.ndarray, caption: str, *, width: int = 640) -> str:
    """An image (H, W, 3) uint8 as JPEG, a fifth of the size of a PNG, with its caption."""
    return _figure("image/jpeg", jpeg_bytes(rgb), caption, width)


def _figure(kind: str, content: bytes, caption: str, width: int) -> str:
    text, data = html.escape(caption), base64.b64encode(content).decode()
    return (
        f"<figure><img width='{width}' src='data:{kind};base64,{data}' "
        f"alt='{text}'><figcaption>{text}</figcaption></figure>"
    )


def jpeg_bytes(rgb: np.ndarray) -> bytes:
    """An image (H, W, 3) uint8 sRGB as a JPEG file."""
    import cv2

    quality = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    return cv2.imencode(".jpg", np.ascontiguousarray(rgb[..., ::-1]), quality)[1].tobytes()


def table(rows: Iterable[Sequence[Any]]) -> str:
    """Names and values, of which numbers are aligned; both are text."""
    lines = []
    for name, value in rows:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        text = f"{value:.5g}" if number else html.escape(str(value))
        kind = " class='n'" if number else ""
        lines.append(f"<tr><td>{html.escape(str(name))}</td><td{kind}>{text}</td></tr>")
    return f"<table>{''.join(lines)}</table>"
