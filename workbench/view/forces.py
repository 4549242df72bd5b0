"""Forces of a press as tables: `forces.csv`, one row per frame, and `slip.csv` where it slides.

Rows are in the order of frames, counted from 1; columns carry their units in their names; forces
act on the object, in the sensor frame, unless the name says support, cut or actuator, which act on
the membrane. Source of the slip curve: SimTac, slip detection, where images tell sticking from
sliding; here motion relative to the object does, and tangential over normal force beside it.
"""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Iterable, Sequence

import numpy as np

from sim.forces.slip import GrossSlip
from sim.forces.slip import gross_slip as gross_slip_of
from workbench.core.base.errors import SolveError
from workbench.core.press.press import Press
from workbench.core.result.force_field import ForceField
from workbench.core.result.sensing import Contact

XYZ = "xyz"
SIDEWAYS_MM = 1e-6
"""Way in the tangent plane below which a path does not go sideways."""
LEAST_N = 1e-9
"""Normal force below which nothing presses, and there is no ratio."""
Columns = dict[str, np.ndarray]


def check_finite(contact: Contact) -> None:
    """Refuse a result with a value that other programs could not read.

    Raises:
        SolveError: Naming the field and the first frame that holds one.
    """
    for item in dataclasses.fields(contact):
        values = getattr(contact, item.name)
        if isinstance(values, np.ndarray) and not np.isfinite(values).all():
            frame = int(np.argwhere(~np.isfinite(np.atleast_1d(values)))[0][0])
            raise SolveError(
                f"{item.name} of frame {frame + 1} holds a value that is not finite",
                hint="lower press.depth_mm or contact.grid_mm, and report it",
                frame=frame,
            )


def force_columns(path: Press, contact: Contact, depths_mm: Sequence[float]) -> Columns:
    """The columns of `forces.csv`, each of shape (K,).

    Args:
        path: The press.
        contact: Its result, perhaps of fewer frames than the path has.
        depths_mm: Depth of each frame [mm].
    """
    count = len(contact.reaction_N)
    tangent_v = np.cross(contact.normal, contact.tangent_u)
    columns: Columns = {
        "frame": np.arange(1, count + 1),
        "t_s": path.times_s()[1 : count + 1],
        "depth_mm": np.asarray(depths_mm),
        "normal_N": contact.normal_N,
        "tangential_u_N": contact.reaction_N @ contact.tangent_u,
        "tangential_v_N": contact.reaction_N @ tangent_v,
        **_vector("reaction", "N", contact.reaction_N),
        **_vector("moment", "Nmm", contact.moment_Nmm),
        **_vector("support", "N", contact.support_N),
        **_vector("support_moment", "Nmm", contact.support_moment_Nmm),
        **_vector("cut", "N", contact.cut_N),
        "pressing_N": contact.pressing_N,
        "tangential_N": contact.tangential_N,
        "friction_ratio": contact.friction_ratio,
        "sliding_share": sliding_share(contact),
        "penetration_mm": contact.penetration_mm,
        "residual": contact.residual,
        "kinetic_ratio": contact.kinetic_ratio,
        "least_volume_ratio": contact.least_volume_ratio,
        "strain_energy_Nmm": contact.strain_energy_Nmm,
    }
    for number in range(len(path.actuations)):
        name = f"actuator_{number}"
        columns |= _vector(name, "N", contact.actuator_N[:, number])
        columns |= _vector(f"{name}_moment", "Nmm", contact.actuator_moment_Nmm[:, number])
    columns["seconds"] = contact.frame_seconds
    # The particle method does not know all of them.
    return {name: values for name, values in columns.items() if len(values) == count}


def slip_columns(contact: Contact) -> Columns | None:
    """The columns of `slip.csv`, each of shape (K,); None where nothing goes or can slide."""
    way_mm = sideways_mm(contact)
    if way_mm.max(initial=0.0) < SIDEWAYS_MM or not len(contact.slip_mm):
        return None
    slid = contact.slip_mm > 0.0
    ratio, share = slip_curve(contact)
    mean_mm = contact.slip_mm.sum(axis=1) / np.maximum(slid.sum(axis=1), 1)
    return {
        "frame": np.arange(1, len(way_mm) + 1),
        "way_mm": way_mm,
        "tangential_N": contact.tangential_N,
        "pressing_N": contact.pressing_N,
        "ratio": ratio,
        "sliding_share": share,
        "mean_slip_mm": mean_mm.astype(np.float64),
    }


def slip_curve(contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """Tangential over normal force, and share of the contact's area that slides, each (K,).

    Sums over contact points; 0 where nothing presses, or where the result lacks the forces.
    """
    ratio = np.zeros(len(contact.reaction_N))
    if len(contact.pressing_N) == len(contact.tangential_N) == len(ratio):
        pressed = contact.pressing_N > LEAST_N
        ratio[pressed] = contact.tangential_N[pressed] / contact.pressing_N[pressed]
    return np.nan_to_num(ratio), sliding_share(contact)


def sideways_mm(contact: Contact | ForceField) -> np.ndarray:
    """Way of the object's origin in the tangent plane since the first frame [mm], shape (K,)."""
    steps_mm = np.diff(contact.indenter_pose[:, :3], axis=0)
    steps_mm = steps_mm - np.outer(steps_mm @ contact.normal, contact.normal)
    return np.append(0.0, np.cumsum(np.linalg.norm(steps_mm, axis=1)))


def sliding_share(contact: Contact | ForceField) -> np.ndarray:
    """Share of the contact's area that slides, shape (K,); 0 where the source does not know it."""
    if len(contact.sliding_share):
        return contact.sliding_share
    return np.zeros(len(contact.reaction_N))


def gross_slip(contact: Contact | ForceField) -> GrossSlip | None:
    """When all of the contact began to slide; None if it did not, or nobody knows."""
    return gross_slip_of(contact.sliding_share, sideways_mm(contact)[: len(contact.sliding_share)])


def csv_bytes(columns: Columns) -> bytes:
    """Columns of one length as a CSV file; numbers to nine digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(_rows(columns.values()))
    return text.getvalue().encode()


def _rows(columns: Iterable[np.ndarray]) -> Iterable[list[str]]:
    for row in zip(*columns, strict=True):
        yield [f"{value:.9g}" for value in row]


def _vector(name: str, unit: str, values: np.ndarray) -> Columns:
    return {f"{name}_{axis}_{unit}": values[:, k] for k, axis in enumerate(XYZ)}
