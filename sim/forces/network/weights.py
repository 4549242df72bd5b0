"""A trained network as one file: arrays, what they belong to, and where they come from.

Three lines, then the numbers: format and version; the SHA-256 of all that follows; a header in
JSON, which lists the arrays; the arrays, little-endian, one after the other. Nothing in a file is
executed. Its name ends in the beginning of the hash, so that a result can say which weights made
it, and a file that was damaged or exchanged is refused. Imports no PyTorch: a data card can be read
without.

Left out: the optimiser and the epoch, which belong to the checkpoints of a training; writing the
file, which is for the caller, whole or not at all.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from sim.forces.network.spec import Activation, NetworkSpec, Norm, Target
from workbench.core.base.errors import StoreError, WorkbenchError

FORMAT = b"sensor-workbench force network "
VERSION = 2
READABLE = (1, 2)
"""Files of version 1 look at the whole skin."""
SUFFIX = ".weights"
HASH_DIGITS = 16
"""Of the content hash in a file name."""
MOST_BYTES = 500_000_000
"""Of a file: ten times the published network in float32."""
KINDS = ("<f2", "<f4", "<i8")
_AGAIN = "copy or download the file again, or train the network again"


class Storage(StrEnum):
    """Type in which matrices are written."""

    SINGLE = "single"
    HALF = "half"
    """float16: half the size; a weight moves by at most 2^-11 of itself, outputs by less than 1e-3
    of the largest. Vectors (biases, normalisation) stay float32."""


@dataclass(frozen=True, kw_only=True, slots=True)
class NetworkWeights:
    """A network with all that is needed to use it."""

    spec: NetworkSpec
    arrays: Mapping[str, np.ndarray]
    """The network's state by name, float32 (whole numbers for counters)."""
    target: Target
    input_scale_mm: float
    """Displacements are divided by it before they enter the network."""
    output_scale: tuple[float, ...]
    """What the network's outputs are multiplied by, per channel, in the unit of the target."""
    voxel_per_spacing: float
    """Edge of a voxel over the spacing of the points."""
    spacing_mm: float
    """Spacing of the points it was trained on: a nodal force grows with the area of a point."""
    force_scale_N: float = 0.0
    """The contact solver's forces are divided by it and enter beside its displacements; 0: they do
    not."""
    corrects: bool = False
    """Whether the output is added to the contact solver's own field."""
    patch_spacings: float = 0.0
    """The network sees no point farther than so many spacings from those that the contact solver's
    own field is at, see `patches`; 0: it sees the whole skin."""
    card: Mapping[str, Any]
    """The data card: free JSON about the data and the training."""

    @property
    def takes_force(self) -> bool:
        """Whether the contact solver's forces enter too."""
        return self.force_scale_N > 0.0

    @property
    def input_scale(self) -> tuple[float, ...]:
        """What each channel that enters is divided by."""
        force = (self.force_scale_N,) * 3 if self.takes_force else ()
        return (self.input_scale_mm,) * 3 + force


def weights_to_bytes(
    weights: NetworkWeights, *, storage: Storage = Storage.SINGLE
) -> tuple[str, bytes]:
    """Name and content of the file; the same weights always give the same bytes.

    Raises:
        StoreError: If a weight or a scale is not finite, or a number is too large for float16.
    """
    arrays = {name: _stored(array, storage) for name, array in sorted(weights.arrays.items())}
    _expect_finite(arrays, weights)
    listed = [[name, array.dtype.str, array.shape] for name, array in arrays.items()]
    header = json.dumps({**_described(weights), "arrays": listed}, sort_keys=True).encode()
    body = header + b"\n" + b"".join(array.tobytes() for array in arrays.values())
    digest = hashlib.sha256(body).hexdigest()
    name = f"{weights.spec.name}-{weights.target}-{digest[:HASH_DIGITS]}{SUFFIX}"
    return name, FORMAT + f"{VERSION}\n{digest}\n".encode() + body


def weights_from_bytes(name: str, content: bytes) -> NetworkWeights:
    """The weights of a file.

    Args:
        name: File name, which ends in the content hash.
        content: The file.

    Raises:
        StoreError: If it is damaged, cut short, renamed, of another program or version, or if a
            weight is not finite.
    """
    body = _checked_body(name, content)
    try:
        line, _, numbers = body.partition(b"\n")
        header = json.loads(line)
        arrays = _arrays(header["arrays"], numbers)
        weights = _from_header(header, arrays)
    except (KeyError, TypeError, ValueError, WorkbenchError) as error:
        raise StoreError(
            f"{name} does not describe a network: {error}", hint=_AGAIN, at=name
        ) from error
    _expect_finite(arrays, weights)
    return weights


def load_weights(path: Path) -> NetworkWeights:
    """The weights of a file on disk.

    Raises:
        StoreError: As `weights_from_bytes`, or if the file cannot be read.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise StoreError(
                f"{path} is larger than the {MOST_BYTES // 10**6} MB that weights may have",
                hint=f"choose a file that ends in {SUFFIX}",
                at=str(path),
            )
        content = path.read_bytes()
    except OSError as error:
        raise StoreError(
            f"cannot read {path}: {error.strerror or error}",
            hint="check the path and the right to read it",
            at=str(path),
        ) from error
    return weights_from_bytes(path.name, content)


def _checked_body(name: str, content: bytes) -> bytes:
    """What the hash covers, once it fits the hash and the name."""
    if not content.startswith(FORMAT):
        raise StoreError(
            f"{name} holds no force network",
            hint=f"choose a file that ends in {SUFFIX}, written by this program",
            at=name,
        )
    first, digest, body = (*content.split(b"\n", 2), b"", b"")[:3]
    version = first.removeprefix(FORMAT)
    if version not in [str(number).encode() for number in READABLE]:
        raise StoreError(
            f"{name} has format version {version[:8].decode(errors='replace')}, "
            f"this program reads up to {VERSION}",
            hint="use weights of this version, or train the network again",
            at=name,
        )
    found = hashlib.sha256(body).hexdigest()
    if digest != found.encode():
        raise StoreError(
            f"{name} is damaged or cut short: its content is not what was written",
            hint=_AGAIN,
            at=name,
        )
    if not PurePath(name).stem.endswith(found[:HASH_DIGITS]):
        raise StoreError(
            f"{name} was renamed or exchanged: its content belongs to {found[:HASH_DIGITS]}",
            hint=f"call it NAME-{found[:HASH_DIGITS]}{SUFFIX} if it is the one you want",
            at=name,
        )
    return body


def _stored(array: np.ndarray, storage: Storage) -> np.ndarray:
    if array.dtype.kind != "f":
        return array.astype("<i8")
    half = storage is Storage.HALF and array.ndim > 1
    # A number beyond float16 becomes infinite, which is then refused by name.
    with np.errstate(over="ignore"):
        return array.astype("<f2" if half else "<f4")


def _arrays(listed: list[Any], numbers: bytes) -> dict[str, np.ndarray]:
    """The arrays that a header lists; it must account for every byte."""
    arrays, first = {}, 0
    for name, kind, shape in listed:
        if kind not in KINDS:
            raise ValueError(f"{name} is of type {kind}")
        count = math.prod(shape)
        end = first + count * np.dtype(kind).itemsize
        if min(shape, default=0) < 0 or end > len(numbers):
            raise ValueError(f"{name} is longer than the file")
        arrays[name] = np.frombuffer(numbers[first:end], dtype=kind).reshape(shape)
        first = end
    if first != len(numbers):
        raise ValueError("the file is longer than its arrays")
    return arrays


def _described(weights: NetworkWeights) -> dict[str, Any]:
    plain = {
        field.name: getattr(weights, field.name)
        for field in dataclasses.fields(weights)
        if field.name not in ("spec", "arrays", "card")
    }
    return {**plain, "spec": dataclasses.asdict(weights.spec), "card": dict(weights.card)}


def _from_header(header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> NetworkWeights:
    spec = dict(header["spec"])
    spec["planes"] = tuple(spec["planes"])
    spec["norm"], spec["activation"] = Norm(spec["norm"]), Activation(spec["activation"])
    return NetworkWeights(
        spec=NetworkSpec(**spec),
        arrays={
            name: array.astype(np.float32) if array.dtype.kind == "f" else array
            for name, array in arrays.items()
        },
        target=Target(header["target"]),
        input_scale_mm=float(header["input_scale_mm"]),
        output_scale=tuple(float(scale) for scale in header["output_scale"]),
        voxel_per_spacing=float(header["voxel_per_spacing"]),
        spacing_mm=float(header["spacing_mm"]),
        # Files of before a network could take the contact solver's force, or a patch, have none.
        force_scale_N=float(header.get("force_scale_N", 0.0)),
        corrects=bool(header.get("corrects", False)),
        patch_spacings=float(header.get("patch_spacings", 0.0)),
        card=header["card"],
    )


def _expect_finite(arrays: Mapping[str, np.ndarray], weights: NetworkWeights) -> None:
    bad = [name for name, array in arrays.items() if not np.isfinite(array).all()]
    scales = (weights.input_scale_mm, *weights.output_scale, weights.spacing_mm)
    if not all(math.isfinite(scale) and scale > 0.0 for scale in scales):
        bad.append("the scales")
    if not (math.isfinite(weights.force_scale_N) and weights.force_scale_N >= 0.0):
        bad.append("the scale of the force")
    if not (math.isfinite(weights.patch_spacings) and weights.patch_spacings >= 0.0):
        bad.append("the size of the patch")
    if bad:
        raise StoreError(
            f"weights that are not finite, or scales that are not positive: {', '.join(bad[:3])}",
            hint="the training diverged: go back to an earlier checkpoint, or lower the rate",
            at="weights",
        )
