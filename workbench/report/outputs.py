"""What `workbench run` leaves in its folder: images, arrays, mould files, summary and report."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.design.design import SensorDesign
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Bundle, MembraneMesh, Solid
from workbench.core.result.sensing import Contact, Shot
from workbench.edit.trajectories import pose_csv, press_poses
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store
from workbench.pipeline.touching_side import touching_notice
from workbench.planning.plan import results
from workbench.project.aim import target_notice
from workbench.report.fabrication_tables import fabrication_tables, plain_numbers
from workbench.report.image_files import write_images
from workbench.report.map_files import write_maps
from workbench.report.vtkfiles import write_vtk
from workbench.system.folder import remove_stale
from workbench.system.whole_files import write_atomically
from workbench.view.forces import (
    check_finite,
    csv_bytes,
    force_columns,
    gross_slip,
    sliding_share,
    slip_columns,
)
from workbench.view.press_figures import force_balance, frame_depths_mm

SUMMARY_SCHEMA = 1


def write_contact(out: Path, mesh: MembraneMesh, contact: Contact) -> None:
    """Write `contact.npz` with the arrays that other tools read."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        surface_points_mm=mesh.outer.points_mm,
        surface_faces=mesh.outer.faces,
        displacement_mm=contact.displacement_mm,
        reaction_N=contact.reaction_N,
        indenter_pose=contact.indenter_pose,
        moment_Nmm=contact.moment_Nmm,
        support_N=contact.support_N,
        cut_N=contact.cut_N,
        residual=contact.residual,
        penetration_mm=contact.penetration_mm,
        sliding=contact.sliding,
        contact_force_N=contact.contact_force_N,
        pressure_MPa=contact.pressure_MPa,
        cauchy_MPa=contact.cauchy_MPa,
        energy_MPa=contact.energy_MPa,
        slip_mm=contact.slip_mm,
        support_moment_Nmm=contact.support_moment_Nmm,
        actuator_N=contact.actuator_N,
        actuator_moment_Nmm=contact.actuator_moment_Nmm,
        sensor_pose=contact.sensor_pose,
    )
    write_atomically(out / "contact.npz", buffer.getvalue())


def write_press(out: Path, path: Press, solid: Solid, mesh: MembraneMesh, contact: Contact) -> None:
    """Write everything of a press but images and numbers of the summary.

    `contact.npz`, `poses.csv`, `forces.csv`, `slip.csv` (of a path that goes sideways) and the VTK
    files; of an earlier run's such files none is left.

    Raises:
        SolveError: If the result holds a value that is not finite.
        StoreError: If the folder cannot be written.
    """
    check_finite(contact)
    depths_mm = frame_depths_mm(path, contact)
    write_contact(out, mesh, contact)
    write_atomically(out / "poses.csv", pose_csv(*press_poses(path, contact)).encode())
    write_atomically(out / "forces.csv", csv_bytes(force_columns(path, contact, depths_mm)))
    slip = slip_columns(contact)
    if slip is None:
        remove_stale(out, ("slip.csv",), keep=())
    else:
        write_atomically(out / "slip.csv", csv_bytes(slip))
    write_vtk(out, solid, mesh, contact=contact, depth_mm=depths_mm)


def write_package(out: Path, bundle: Bundle) -> None:
    """Write every file of the workshop; files of an earlier run that are not among them go."""
    for folder in ("moulds", "parts"):
        keep = {Path(name).name for name in bundle.files if name.startswith(f"{folder}/")}
        remove_stale(out / folder, ("*.stl", "*.step", "*.3mf"), keep=keep)
    for name, content in bundle.files.items():
        write_atomically(out / name, content.tobytes())


def contact_summary(contact: Contact, path: Press, seconds: float) -> dict[str, Any]:
    """The `contact` table of `summary.json`: last frame's force, worst residual and penetration.

    `gross_slip_mm` is the way along the skin at which all of the contact began to slide, and
    `gross_slip_frame` the frame; None where it did not.
    """
    times_s = path.times_s()
    shares, gross = sliding_share(contact), gross_slip(contact)
    frames = [
        {
            "t_s": float(times_s[k + 1]),
            "depth_mm": depth,
            "reaction_N": contact.reaction_N[k].tolist(),
            "normal_N": float(contact.normal_N[k]),
            "sliding_share": float(shares[k]),
            "residual": float(contact.residual[k]),
            "penetration_mm": float(contact.penetration_mm[k]),
            "actuator_N": contact.actuator_N[k].tolist() if len(contact.actuator_N) else [],
        }
        for k, depth in enumerate(frame_depths_mm(path, contact))
    ]
    return {
        "reaction_N": contact.reaction_N[-1].tolist(),
        "normal_N": float(contact.normal_N[-1]),
        "moment_Nmm": contact.moment_Nmm[-1].tolist(),
        "sliding_share": float(shares[-1]),
        "gross_slip_mm": None if gross is None else gross.way_mm,
        "gross_slip_frame": None if gross is None else gross.frame,
        "residual": float(contact.residual.max()),
        "penetration_mm": float(contact.penetration_mm.max()),
        "force_balance": force_balance(contact),
        "particles": contact.particles,
        "grid_mm": contact.grid_mm,
        "active_radius_mm": contact.active_radius_mm,
        "substeps": contact.substeps,
        "seconds": seconds,
        "frames": frames,
    }


def press_summary(case: PressCase, contact: Contact) -> dict[str, Any]:
    """What was pressed where, as comparisons of image sets group it.

    The contact angle is that of the outward normal to the sensor's axis +Z, 0 at the tip; the
    position is the height of the target above the base.
    """
    angle_deg = math.degrees(math.acos(max(-1.0, min(1.0, float(contact.normal[2])))))
    return {
        "indenter": case.indenter.kind.value,
        "size_mm": case.indenter.size_mm,
        "turn_deg": list(case.indenter.turn_deg),
        "target_mm": contact.target_mm.tolist(),
        "angle_deg": round(angle_deg),
        "azimuth_deg": math.degrees(math.atan2(*contact.target_mm[1::-1])),
        "position_mm": float(contact.target_mm[2]),
        "depths_mm": frame_depths_mm(case.press, contact),
    }


def summary_table(
    design: SensorDesign,
    case: PressCase,
    contact: Contact,
    shot: Shot,
    seconds: float,
    outcomes: Sequence[Outcome],
) -> dict[str, Any]:
    """Everything of `summary.json` except the files.

    Args:
        design: The sensor.
        case: The press.
        contact: Its result.
        shot: Its images.
        seconds: Time the contact took [s].
        outcomes: Stages that are done.
    """
    return {
        "schema": SUMMARY_SCHEMA,
        "design": design.name,
        "family": design.family,
        "device": contact.device,
        "stages": [
            {"stage": o.stage, "key": o.key, "cached": o.cached, "seconds": o.seconds}
            for o in outcomes
        ],
        "light_model": design.optics.light_model.value,
        "press": press_summary(case, contact),
        "contact": contact_summary(contact, case.press, seconds),
        "metrics": dict(shot.metrics.values),
    }


@dataclass(frozen=True, kw_only=True, slots=True)
class FinishedRun:
    """A design and a press whose results are in the store."""

    design: SensorDesign
    case: PressCase
    calls: dict[str, Call]
    """Of the whole chain, by stage."""
    outcomes: Sequence[Outcome]
    """Stages that are done."""
    changed: str = ""
    """What the command itself changed of the design; stands among the notices."""


def write_all(
    out: Path, finished: FinishedRun, store: Store, *, fields: bool = False
) -> dict[str, Any]:
    """Write every file of a run; returns the summary.

    Args:
        out: Folder of the run.
        finished: What was computed.
        store: Where its results are.
        fields: Write depth, normals and masks of every pixel too.

    Raises:
        StoreError: If the folder cannot be written.
    """
    from workbench.report.report import drawings, report_html

    design, case, calls = finished.design, finished.case, finished.calls
    path = case.press
    load = results(store, calls, calls)
    seconds = store.entry("press", calls["press"].key).seconds
    summary = summary_table(design, case, load["press"], load["shoot"], seconds, finished.outcomes)
    summary["images"] = write_images(out, load["shoot"], fields=fields)
    maps = load.get("maps")
    summary["maps"] = write_maps(out, load["mesh"], maps)
    write_press(out, path, load["build"], load["mesh"], load["press"])
    write_package(out, load["package"])
    summary["notices"] = {
        name: value.notice for name, value in load.items() if getattr(value, "notice", "")
    }
    notices = {"press": path.notice, "material": design.material.notice, "design": finished.changed}
    notices["object"] = touching_notice(case.indenter)
    notices["target"] = target_notice(design, load["build"], path, load["press"])
    summary["notices"] |= {name: notice for name, notice in notices.items() if notice}
    summary |= fabrication_tables(load["mould"], load["housing"], load["recipe"])
    drawn = drawings(load["build"], load["mesh"], load["press"], load.get("picture"))
    html = report_html(design, path, summary, load["shoot"], load["press"], drawn)
    write_atomically(out / "report.html", html.encode())
    text = json.dumps(plain_numbers(summary), indent=1, allow_nan=False)
    write_atomically(out / "summary.json", text.encode())
    return summary
