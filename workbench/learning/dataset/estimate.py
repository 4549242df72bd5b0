"""What a data set costs, from the seconds that its finished cases took; never from a guess."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from workbench.core.base.units import human_seconds

PAPER_SAMPLES = 9980
"""Samples of the finger that the paper's network was trained and tested with. Source: SimTac."""
HOUR_S = 3600.0
PARTS = ("mpm_s", "fem_s", "image_s", "cpu_s", "seconds")


def estimate(
    times: Sequence[Mapping[str, Any]], samples_left: int, *, jobs: int = 1
) -> dict[str, Any]:
    """Cost by the mean of finished cases.

    Args:
        times: Rows of `times.jsonl`; may be empty, then nothing is known.
        samples_left: Samples that are still to be made.
        jobs: Processes that will make them.

    Returns:
        `cases_timed`, and where that is not 0 seconds per sample by part, core-hours of the rest
        and of the paper's 9,980 samples, and hours until the rest is done. Core-hours are processor
        time of one-threaded workers, loading included; hours suppose a core for each.
    """
    known: dict[str, Any] = {"cases_timed": len(times), "samples_left": samples_left}
    samples = sum(row["frames"] for row in times)
    if not samples:
        return known
    per_sample = {f"{name}_per_sample": sum(r[name] for r in times) / samples for name in PARTS}
    core_s = per_sample["cpu_s_per_sample"]
    return {
        **known,
        "samples_timed": samples,
        **per_sample,
        "hours_left": per_sample["seconds_per_sample"] * samples_left / HOUR_S / jobs,
        "core_hours_left": core_s * samples_left / HOUR_S,
        "core_hours_paper": core_s * PAPER_SAMPLES / HOUR_S,
    }


def estimate_text(found: Mapping[str, Any]) -> str:
    """An estimate in words."""
    if "samples_timed" not in found:
        return (
            f"{found['samples_left']} samples are left; no case of this data set is finished yet, "
            "so nothing is known of its cost"
        )
    parts = ", ".join(
        f"{label} {found[f'{name}_per_sample']:.2f} s"
        for label, name in (("mpm", "mpm_s"), ("fem", "fem_s"), ("images", "image_s"))
    )
    return (
        f"measured on {found['cases_timed']} cases, {found['samples_timed']} samples: {parts} a "
        f"sample, {found['cpu_s_per_sample']:.2f} core-seconds in all\n"
        f"{found['samples_left']} samples are left: {found['core_hours_left']:.2f} core-hours "
        f"({human_seconds(found['hours_left'] * HOUR_S)} from now, a core for each process)\n"
        f"the paper's {PAPER_SAMPLES:,} samples at this pace: "
        f"{found['core_hours_paper']:.1f} core-hours"
    )
