"""Files of weights: what comes back, and what is refused."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.forces.network.kernel_maps import kernel_maps
from sim.forces.network.minkunet import arrays_of, network_of, new_network
from sim.forces.network.spec import NetworkSpec, Norm, Target
from sim.forces.network.voxels import voxelise
from sim.forces.network.weights import (
    FORMAT,
    SUFFIX,
    NetworkWeights,
    Storage,
    load_weights,
    weights_from_bytes,
    weights_to_bytes,
)
from workbench.core.base.errors import StoreError
from workbench.pipeline.weight_files import save_weights
from workbench.proof.benchmarks.forces import shell

SPEC = NetworkSpec(
    name="tiny", planes=(4, 6, 8, 8, 8, 6, 6, 4), stem_planes=4, output_channels=6, norm=Norm.ALL
)


def make_weights() -> NetworkWeights:
    return NetworkWeights(
        spec=SPEC,
        arrays=arrays_of(new_network(SPEC, seed=8)),
        target=Target.STRESS,
        input_scale_mm=0.7,
        output_scale=(0.01, 0.02, 0.03, 0.04, 0.05, 0.06),
        voxel_per_spacing=0.75,
        spacing_mm=0.9,
        card={"samples": 3, "membranes": ["finger"], "note": "ä"},
    )


def test_weights_come_back_bit_by_bit() -> None:
    """Arrays, network, scales and card are equal, and written again give the same file."""
    weights = make_weights()
    name, content = weights_to_bytes(weights)
    again = weights_from_bytes(name, content)
    assert again.arrays.keys() == weights.arrays.keys()
    for key, array in weights.arrays.items():
        np.testing.assert_array_equal(again.arrays[key], array)
        assert again.arrays[key].dtype == array.dtype
    for field in dataclasses.fields(weights):
        if field.name != "arrays":
            assert getattr(again, field.name) == getattr(weights, field.name)
    assert weights_to_bytes(again) == (name, content)


def test_name_tells_network_target_and_content() -> None:
    """`tiny-stress-<16 digits>.weights`; one number of the card changes the digits."""
    name, content = weights_to_bytes(make_weights())
    digest = content.split(b"\n")[1].decode()
    assert name == f"tiny-stress-{digest[:16]}{SUFFIX}"
    other, _ = weights_to_bytes(dataclasses.replace(make_weights(), card={"samples": 4}))
    assert other != name


def test_half_storage_halves_the_file_and_moves_outputs_by_less_than_a_thousandth() -> None:
    """The stated error, relative to the largest output; vectors keep every bit."""
    weights = make_weights()
    single, half = weights_to_bytes(weights), weights_to_bytes(weights, storage=Storage.HALF)
    again = weights_from_bytes(*half)
    voxels = voxelise(shell(300), voxel_mm=1.5)
    maps, features = kernel_maps(voxels), torch.randn(voxels.count, 1, 3)
    with torch.no_grad():
        expected = network_of(weights).eval()(features, maps)
        found = network_of(again).eval()(features, maps)
    # The header and the vectors of so small a network are the rest.
    assert len(half[1]) < 0.6 * len(single[1])
    assert 0.0 < float((found - expected).abs().max() / expected.abs().max()) < 1e-3
    for name, array in weights.arrays.items():
        if array.ndim < 2:
            np.testing.assert_array_equal(again.arrays[name], array)


def test_stored_half_twice_is_the_same_file() -> None:
    """What float16 has lost is lost once."""
    name, content = weights_to_bytes(make_weights(), storage=Storage.HALF)
    again = weights_from_bytes(name, content)
    assert weights_to_bytes(again, storage=Storage.HALF) == (name, content)


def test_saved_files_are_loaded(tmp_path: Path) -> None:
    """A folder that was not there holds one file, under the name of its content."""
    path = save_weights(tmp_path / "weights", make_weights(), storage=Storage.SINGLE)
    assert [file.name for file in path.parent.iterdir()] == [weights_to_bytes(make_weights())[0]]
    assert load_weights(path).card["samples"] == 3
    with pytest.raises(StoreError, match="cannot read"):
        load_weights(tmp_path / "none.weights")


def refused(name: str, content: bytes) -> StoreError:
    with pytest.raises(StoreError) as caught:
        weights_from_bytes(name, content)
    assert caught.value.hint and caught.value.at
    return caught.value


@pytest.mark.parametrize("cut", [1, 4, 1000, 20_000])
def test_truncated_files_are_refused(cut: int) -> None:
    """However little is missing at the end."""
    name, content = weights_to_bytes(make_weights())
    assert "damaged or cut short" in refused(name, content[:-cut]).message


def test_every_damaged_byte_is_found() -> None:
    """One bit changed in the header line, in the JSON, in the middle, at the end."""
    name, content = weights_to_bytes(make_weights())
    for place in (len(FORMAT) + 5, 150, len(content) // 2, len(content) - 1):
        damaged = bytearray(content)
        damaged[place] ^= 1
        assert "damaged" in refused(name, bytes(damaged)).message


def test_files_cut_inside_the_first_lines_are_refused() -> None:
    """No length of a beginning is taken for a network, and none ends in a traceback."""
    name, content = weights_to_bytes(make_weights())
    for length in range(110):
        refused(name, content[:length])


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 a zip", b"\x80\x04 a pickle", b"\n\n\n"])
def test_foreign_files_are_refused(content: bytes) -> None:
    """Whatever is no file of weights is named as such."""
    assert "holds no force network" in refused("thing.weights", content).message


def test_another_version_is_refused() -> None:
    """The version that was found and the one that is read are both named."""
    name, content = weights_to_bytes(make_weights())
    newer = content.replace(FORMAT + b"2\n", FORMAT + b"3\n", 1)
    message = refused(name, newer).message
    assert "version 3" in message and "up to 2" in message


def test_renamed_files_are_refused_with_the_right_name() -> None:
    """A file under another's name is not taken for it; the remedy says what to call it."""
    name, content = weights_to_bytes(make_weights())
    error = refused("paper-force-0123456789abcdef.weights", content)
    assert name[-24:] in error.hint


def test_weights_that_are_not_finite_are_neither_written_nor_read() -> None:
    """A NaN in one array; a number that float16 does not reach; a scale of zero."""
    weights = make_weights()
    bad = {**weights.arrays, "last.bias": np.full(6, np.nan, np.float32)}
    with pytest.raises(StoreError, match=r"last\.bias"):
        weights_to_bytes(dataclasses.replace(weights, arrays=bad))
    large = {**weights.arrays, "last.weight": np.full((6, 4), 1e6, np.float32)}
    with pytest.raises(StoreError, match=r"last\.weight"):
        weights_to_bytes(dataclasses.replace(weights, arrays=large), storage=Storage.HALF)
    with pytest.raises(StoreError, match="scales"):
        weights_to_bytes(dataclasses.replace(weights, input_scale_mm=0.0))


def forged(change: dict[str, object], *, numbers: bytes | None = None) -> tuple[str, bytes]:
    """A file with another header, or other numbers, and a hash that fits."""
    _, content = weights_to_bytes(make_weights())
    first, _, header, rest = content.split(b"\n", 3)
    body = json.dumps({**json.loads(header), **change}).encode() + b"\n"
    body += rest if numbers is None else numbers
    digest = hashlib.sha256(body).hexdigest()
    return f"x-{digest[:16]}{SUFFIX}", first + b"\n" + digest.encode() + b"\n" + body


@pytest.mark.parametrize(
    "change",
    [
        {"arrays": []},
        {"arrays": [["a", "<f4", [10**12]]]},
        {"arrays": [["a", "<f4", [-4, -4]]]},
        {"arrays": [["a", "|O", [1]]]},
        {"arrays": 7},
        {"spec": {"name": "x"}},
        {"target": "colour"},
        {"output_scale": None},
    ],
)
def test_headers_that_lie_are_refused(change: dict[str, object]) -> None:
    """Arrays that do not fill the file or overflow it, objects, and networks that are none."""
    refused(*forged(change))


def test_nan_in_a_file_is_refused() -> None:
    """A file whose hash fits but whose numbers are all NaN."""
    _, content = weights_to_bytes(make_weights())
    rest = content.split(b"\n", 3)[3]
    name, bad = forged({}, numbers=b"\xff" * len(rest))
    assert "not finite" in refused(name, bad).message


def test_reading_a_data_card_loads_no_torch() -> None:
    """`spec` and `weights` are for the front too."""
    code = "import sys, sim.forces.network.weights; print('torch' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
