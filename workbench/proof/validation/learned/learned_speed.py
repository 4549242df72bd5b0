"""Frame rates of the network: measured here, and on record for a GPU."""

from __future__ import annotations

from pathlib import Path

from workbench.core.base.errors import StoreError
from workbench.proof.benchmarks.records import SHIPPED, RoomRecord, load, shipped_records
from workbench.proof.row import Row, bounded, failed

NAMES = {
    "1k": "published network, 1,000 points",
    "5k": "published network, 5,000 points",
    "25k": "published network, 25,000 points",
    "patch_25k": "learned forces around a dent, 25,000 points, float32",
}
DEVICES = {"cpu": "two CPU cores", "cuda": "one data-centre GPU"}
RECORD = "workbench bench efficiency --record FILE"


def rows(folder: Path = SHIPPED) -> list[Row]:
    """The published network and the small one here; on each GPU on record also learned forces."""
    return [*here_rows(), *recorded_rows(folder)]


def here_rows() -> list[Row]:
    """Kernel maps at hand, copies included, in the fastest type; null: what the paper reports."""
    from workbench.proof.benchmarks.forces import NETWORKS, paces

    found = []
    for network in NETWORKS:
        for pace in paces(network):
            found.append(
                bounded(
                    f"learned_inference_{pace.name}",
                    f"{pace.case}; load {load():.1f}",
                    pace.fps,
                    unit="1/s",
                    limit=pace.least_fps,
                    sense="min",
                    null=_paper_fps(pace.name),
                )
            )
    return found


def recorded_rows(folder: Path = SHIPPED) -> list[Row]:
    """From the records of GPUs; failed rows where there is none."""
    try:
        records = [record for record in shipped_records(folder) if record.kind == "cuda"]
        records = [record for record in records if record.value("network_1k") is not None]
        why = f"no record of a GPU; make one with {RECORD}"
    except StoreError as error:
        records, why = [], error.message
    if not records:
        return [
            failed(f"learned_inference_gpu_{name}", f"{words}, {DEVICES['cuda']}", unit="1/s",
                   why=why)
            for name, words in NAMES.items()
        ]  # fmt: skip
    return [_recorded(record, name) for record in records for name in NAMES]


def _recorded(record: RoomRecord, name: str) -> Row:
    from workbench.proof.benchmarks.forces import PATCH_LEAST_FPS, SIZES

    asked = {size: limits["cuda"] for size, _, limits in SIZES}
    least = asked.get(name, PATCH_LEAST_FPS["cuda"])
    value = record.value(f"network_{name}")
    case = f"{NAMES[name]}, {record.title}, version {record.version}"
    if value is None:
        return failed(f"learned_inference_gpu_{name}", case, unit="1/s", why="not in the record")
    return bounded(
        f"learned_inference_gpu_{name}",
        case,
        value,
        unit="1/s",
        limit=least,
        sense="min",
        null=_paper_fps(name),
        record=record.kept,
    )


def _paper_fps(name: str) -> float | None:
    from workbench.proof.benchmarks.paces import published_fps

    return published_fps(f"network_{name}")
