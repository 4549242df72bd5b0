"""The report of a calibration: each photograph beside its prediction, scores beside their null."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from workbench.calibration.calibrate import Calibration
from workbench.calibration.determined import directions, parameters
from workbench.calibration.known_places import apart_mm
from workbench.calibration.light_basis import contact_box
from workbench.calibration.scores import PhotoScore, Scored
from workbench.report.html_page import page, photograph
from workbench.report.image_files import difference

STRIP_PX = 150
"""Height of a contact in the report [px]."""
WORDS = """<p>All scores are taken in the box of the contact, 1.45 times its circle. <i>null</i>:
the photograph at rest, what a prediction without any contact scores. <i>polynomial</i>: quadratic
in slope times quadratic in place for each colour, fitted to the same photographs. <i>repeat</i>:
untouched skin against the photograph at rest, as alike as two photographs are. Exposure that
drifted, as untouched skin shows it, is applied to every one of them. Held-out photographs were not
fitted to: they are predicted from place and depth, the depth from the circle where none is
given.</p>"""
HEAD = (
    *("photo", "depth mm", "SSIM", "PSNR dB", "light alone", "polynomial", "null", "null SSIM"),
    "repeat",
)


def report(found: Calibration, scored: Scored, idle: np.ndarray) -> str:
    """The page."""
    body = [
        f"<h1>Calibration of {html.escape(found.design.name)}</h1>",
        _summary(scored),
        *(f"<p>Left out: {html.escape(each.why)}.</p>" for each in found.left_out),
        WORDS,
        _lights(found),
        _unknowns(found),
        "<h2>At rest</h2><div class='images'>",
        photograph(idle, "photograph", width=300),
        photograph(found.rest, "the fitted light alone", width=300),
        photograph(difference(found.rest, idle), "difference x 2", width=300),
        "</div><p>The photograph at rest is the background of every image of the unit; the fitted "
        f"light alone gives it to {scored.idle_psnr_dB:.1f} dB.</p>",
        _scores("Held out", [each for each in scored.photos if each.held_out]),
        _scores("Fitted", [each for each in scored.photos if not each.held_out]),
        _strips(found, scored),
    ]
    return page(f"Calibration of {found.design.name}", "".join(body))


def _summary(scored: Scored) -> str:
    lines = []
    for words, chosen in (
        ("held out", [each for each in scored.photos if each.held_out]),
        ("fitted", [each for each in scored.photos if not each.held_out]),
    ):
        if chosen:
            mean = {
                name: float(np.mean([getattr(each, name) for each in chosen]))
                for name in ("psnr_dB", "polynomial_psnr_dB", "null_psnr_dB", "repeat_psnr_dB")
            }
            lines.append(
                f"<li>{len(chosen)} {words}: <b>{mean['psnr_dB']:.1f} dB</b>, polynomial "
                f"{mean['polynomial_psnr_dB']:.1f}, null {mean['null_psnr_dB']:.1f}, repeat "
                f"{mean['repeat_psnr_dB']:.1f}</li>"
            )
    return f"<ul>{''.join(lines)}</ul>"


def _lights(found: Calibration) -> str:
    strongest = found.powers.lights.max()
    rows: list[Sequence[str]] = [("light", "mount", "place mm", "red", "green", "blue")]
    for number, lamp in enumerate(found.basis.lights):
        place = ", ".join(f"{value:.1f}" for value in lamp.position_mm)
        powers = [f"{value / strongest:.3f}" for value in found.powers.lights[:, number]]
        rows.append((f"{number + 1}", lamp.mount.value, place, *powers))
    ambient = [f"{value / strongest:.3f}" for value in found.powers.ambient]
    rows.append(("ambient", "", "", *ambient))
    whose = "of the design" if found.known else "found around the body"
    left = 100.0 * found.powers.error_grey / max(found.powers.null_grey, 1e-9)
    return (
        f"<h2>Lights {whose}</h2>{_grid(rows)}<p>Powers over the strongest. They leave {left:.0f} "
        "% of what the contacts change. Power, albedo of the coating and exposure scale all light "
        "alike: photographs cannot tell them apart.</p>"
    )


def _unknowns(found: Calibration) -> str:
    """What the photographs determine and what they do not, and Young's modulus."""
    young = ""
    if found.young is not None:
        presses = f"{found.young.presses} presses" if found.young.presses > 1 else "one press"
        young = (
            f"<p>Young's modulus from the force of {presses}: <b>{found.young.young_MPa:.3f} "
            f"&plusmn; {found.young.sd_MPa:.3f} MPa</b>.</p>"
        )
    young += _stage(found)
    if found.refined is None:
        return young
    rows: list[Sequence[str]] = [("unknown", "fitted", "known to", "before", "determined")]
    for each in parameters(found.refined):
        before = "" if each.prior_sd is None else f"{each.prior_sd:.2g} {each.unit}"
        value, sd = f"{each.value:+.3f} {each.unit}", f"{each.sd:.2g} {each.unit}"
        rows.append((each.name, value, sd, before, "yes" if each.determined else each.words))
    seen: list[Sequence[str]] = [("singular value", "combination")]
    for each in directions(found.refined):
        parts = ", ".join(f"{share:+.2f} {name}" for name, share in each.parts)
        seen.append((f"{each.singular_value:.1f}", parts))
    return (
        f"<h2>What the photographs determine</h2>{young}{_grid(rows)}<p>Fitted values are added to "
        "those of the design; powers are over the mean of all lights. <i>known to</i>: one "
        "standard deviation after the fit, <i>before</i>: what was known without photographs. "
        "Determined is what twice its deviation is small enough to rely on.</p>"
        f"<details><summary>Combinations that the photographs see</summary>{_grid(seen)}<p>Of "
        "unknowns over what was known before: a combination of singular value 1 is told by the "
        "photographs as well as it was known before, one far below 1 not at all.</p></details>"
    )


def _stage(found: Calibration) -> str:
    """How far contacts are seen from where a stage pressed them."""
    apart = apart_mm(found.presses)
    if not len(apart):
        return ""
    used = "" if found.refined else "; powers alone were fitted, the camera is the design's"
    return (
        f"<p>A stage knew the places of {len(apart)} of {len(found.presses)} contacts. They are "
        f"seen {np.median(apart):.2f} mm from there (median; {apart.max():.2f} at most){used}.</p>"
    )


def _scores(title: str, chosen: Sequence[PhotoScore]) -> str:
    if not chosen:
        return ""
    rows: list[Sequence[str]] = [HEAD]
    for each in chosen:
        values = (
            f"{each.depth_mm:.2f}",
            f"{each.ssim:.3f}",
            *(
                f"{value:.1f}"
                for value in (
                    each.psnr_dB,
                    each.light_psnr_dB,
                    each.polynomial_psnr_dB,
                    each.null_psnr_dB,
                )
            ),
            f"{each.null_ssim:.3f}",
            f"{each.repeat_psnr_dB:.1f}",
        )
        rows.append((each.photo, *values))
    return f"<h2>{title}</h2>{_grid(rows)}"


def _grid(rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in rows[0])
    lines = [
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
        for row in rows[1:]
    ]
    return f"<table><tr>{head}</tr>{''.join(lines)}</table>"


def _strips(found: Calibration, scored: Scored) -> str:
    """Photograph, prediction and difference of each contact side by side."""
    figures = []
    for seen, each, predicted in zip(found.seen, scored.photos, scored.predicted, strict=True):
        taken = seen.photo.image
        box = contact_box(seen.circle, taken.shape[1], taken.shape[0])
        parts = (taken[box], predicted[box], difference(predicted[box], taken[box]))
        strip = np.hstack([_scaled(part) for part in parts])
        held = ", held out" if each.held_out else ""
        caption = f"{each.photo}{held}: {each.psnr_dB:.1f} dB, null {each.null_psnr_dB:.1f}"
        figures.append(photograph(strip, caption, width=strip.shape[1]))
    head = "<h2>Photograph, prediction, difference x 2</h2>"
    return f"{head}<div class='images'>{''.join(figures)}</div>"


def _scaled(image: np.ndarray) -> np.ndarray:
    import cv2

    width = max(1, round(image.shape[1] * STRIP_PX / image.shape[0]))
    return cv2.resize(np.ascontiguousarray(image), (width, STRIP_PX), interpolation=cv2.INTER_AREA)
