"""What designers read of a job: what happens for them, in the log and when it stops or fails."""

from __future__ import annotations

from workbench.live.requests import (
    COMPLIANCE,
    CUT,
    DRAWN,
    FORESIGHT,
    LIVE,
    PREDICTION,
    SHAPE,
    TOUCH,
)

WORDS = {
    SHAPE: "shaping the body",
    LIVE: "live press",
    TOUCH: "live press",
    COMPLIANCE: "learning how the skin gives",
    FORESIGHT: "looking for what will not fit",
    CUT: "cutting the section",
    DRAWN: "drawing the object",
    PREDICTION: "forces by the network",
    "learned": "forces by the network",
    "forces": "forces by finite elements",
    "maps": "measuring maps",
    "mesh": "checking the mesh",
    "tetrahedra": "meshing with tetrahedra",
    "parts": "making the parts",
    "import": "reading the body",
    "object": "reading the object",
    "variant": "running the variant",
    "contacts": "finding contacts",
    "reading": "reading photos",
    "camera": "following the camera",
    "sensor pack": "making the sensor pack",
    "expected view": "image of the design at rest",
}
"""By job; those that are missing say it by their name."""


def job_words(job: str) -> str:
    """A job in words, as they stand in the middle of a sentence."""
    return WORDS.get(job, job)
