"""The learned reader's network: folding, size, augmentation, loss, file, use without ours."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import numpy as np
import pytest
import torch

from sim.reading.network.augment import NONE, Disturbance, disturbed
from sim.reading.network.crops import cut_to_contact, wider
from sim.reading.network.given import given
from sim.reading.network.loss import Wanted, loss
from sim.reading.network.predictor import Predictor, in_size
from sim.reading.network.reader_file import reader_bytes, reader_from_bytes
from sim.reading.network.rest_view import RestView
from sim.reading.network.shifts import SHIFT_PX, shifted
from sim.reading.network.spec import (
    DEPTH,
    INPUTS,
    OUTPUTS,
    SIZES,
    SURFACE,
    Scales,
    spec_for,
)
from sim.reading.network.standalone import standalone
from sim.reading.network.unet import UNet, folded_state, network_of
from tests.made_readers import COLUMNS, ROWS, reader_file, rest_view, spec
from workbench.core.base.errors import StoreError


def test_folding_normalisation_changes_nothing() -> None:
    """The network for use computes what the trained one does."""
    torch.manual_seed(0)
    trained = UNet(spec(), normed=True)
    images = torch.randn(4, INPUTS, ROWS, COLUMNS)
    for _ in range(3):
        trained(images)
    trained.eval()
    used = network_of(spec(), folded_state(trained))
    with torch.inference_mode():
        for wanted, found in zip(trained(images), used(images), strict=True):
            # Float32 in another order of operations.
            assert torch.allclose(wanted, found, atol=1e-4)


def test_the_full_network_has_about_a_million_parameters() -> None:
    """And the small one a fifth of it."""
    counts = {
        size: sum(part.numel() for part in UNet(spec_for(size, 4, 3), normed=False).parameters())
        for size in SIZES
    }
    assert 0.8e6 < counts["full"] < 1.1e6
    assert counts["small"] < 0.25e6


def test_rows_follow_the_camera_and_are_padded_to_whole_steps() -> None:
    """A 16:9 camera has 180 rows, which the network sees as 192."""
    wide = spec_for("small", 1280, 720)
    assert (wide.columns, wide.rows) == (320, 180)
    grey = torch.zeros(1, 3, wide.rows, wide.columns)
    assert given(grey, grey).shape == (1, INPUTS, 192, 320)


def test_a_force_adds_up_over_the_skin() -> None:
    """Far from each other, two touches push with the sum of their forces."""
    torch.manual_seed(1)
    network = UNet(spec(), normed=False).eval()
    rest = torch.zeros(1, INPUTS, 16, 1024)
    one, two, both = rest.clone(), rest.clone(), rest.clone()
    # Layers that nothing has trained shrink what passes them.
    one[..., 100:110], two[..., 800:810] = 1e5, -1e5
    both += one + two
    with torch.inference_mode():
        forces = [network(images)[1][0, :3] for images in (rest, one, two, both)]
    first, second, sum_of_both = (force - forces[0] for force in forces[1:])
    assert first.abs().max() > 0.1
    # Of float32; the touches are farther apart than the network looks.
    assert torch.allclose(sum_of_both, first + second, rtol=1e-3, atol=1e-3)


def test_disturbances_keep_the_truth_and_none_changes_nothing() -> None:
    """Whole grey levels; noise has the deviation that was asked for."""
    generator = torch.Generator().manual_seed(0)
    idle = torch.full((2, 3, 40, 60), 100.0)
    photos = idle - 20.0
    same = disturbed(idle, photos, NONE, generator)
    assert torch.equal(same[0], idle)
    assert torch.equal(same[1], photos)
    noisy = disturbed(idle, photos, dataclasses.replace(NONE, noise_grey=4.0), generator)
    assert torch.equal(noisy[0], noisy[0].round())
    assert 0.0 < float(noisy[0].std()) < 4.5
    strong = disturbed(idle, photos, Disturbance(noise_grey=0.0), generator)
    # Exposure, balance, flicker and offset: at most 15 %, 6 %, 1 % and one level of 20.
    change = (strong[1] - strong[0]).mean(dim=(1, 2, 3))
    assert torch.all((change < -15.0) & (change > -27.0))


def test_the_loss_is_least_at_the_truth_and_knows_no_force_of_dents() -> None:
    """Right maps cost less than wrong ones; forces that nobody knows cost nothing."""
    depth = torch.zeros(2, 8, 8)
    depth[:, 2:5, 2:5] = 0.6
    depth[0, 0] = torch.nan
    wanted = Wanted(
        depth_mm=depth,
        surface_mm=torch.nan_to_num(depth),
        turn=torch.zeros(2, 3, 8, 8),
        pressure_MPa=torch.zeros(2, 8, 8),
        force_N=torch.ones(2, 3),
        solved=torch.zeros(2),
    )
    scales = Scales(pressure_MPa=0.1, force_N=1.0)
    right = torch.zeros(2, OUTPUTS, 8, 8)
    right[:, DEPTH] = right[:, SURFACE] = torch.nan_to_num(depth)
    nothing = torch.zeros(2, OUTPUTS, 8, 8)
    force = torch.zeros(2, 4)
    good, bad = (loss(maps, force, wanted, scales) for maps in (right, nothing))
    assert float(good["depth"]) == 0.0
    assert float(good["surface"]) == 0.0
    # Nine moved pixels of sixty seen ones weigh 20 each: .6 x 9 x 20 / (60 + 9 x 19).
    assert float(bad["depth"]) == pytest.approx(0.6 * 9 * 20 / (60 + 9 * 19))
    assert float(good["force"]) == 0.0
    known = dataclasses.replace(wanted, solved=torch.ones(2))
    assert float(loss(right, force, known, scales)["force"]) > 0.0


def test_a_file_gives_the_reader_back_in_half_precision() -> None:
    """Matrices within 2^-11 of themselves, all else as it was."""
    reader = reader_file(card={"scores": 1})
    back = reader_from_bytes(reader_bytes(reader), "made")
    for name, array in reader.arrays.items():
        assert np.allclose(back.arrays[name], array, rtol=2.0**-10, atol=1e-7)
    assert (back.spec, back.scales, back.digest) == (reader.spec, reader.scales, reader.digest)
    assert back.card == {"scores": 1}
    assert np.array_equal(back.rest.sees, reader.rest.sees)
    # Places are kept in steps of 1/64 pixel.
    assert np.allclose(back.rest.vertex_px, reader.rest.vertex_px, atol=1 / 64, equal_nan=True)


@pytest.mark.parametrize("damage", [b"", b"no reader", slice(0, 900)])
def test_a_damaged_file_is_refused(damage: bytes | slice) -> None:
    """By name, with what to do."""
    content = reader_bytes(reader_file())
    broken = content[damage] if isinstance(damage, slice) else damage
    with pytest.raises(StoreError, match=r"x.npz is no learned reader"):
        reader_from_bytes(broken, "x.npz")


def test_weights_that_are_not_finite_are_not_written() -> None:
    """A training that diverged leaves no file."""
    reader = reader_file()
    bad = {**reader.arrays, "maps.bias": np.full_like(reader.arrays["maps.bias"], np.nan)}
    with pytest.raises(StoreError, match=r"maps\.bias"):
        reader_bytes(dataclasses.replace(reader, arrays=bad))


def test_normals_of_a_resting_view_survive_their_coarseness() -> None:
    """A tilted plane's normal is kept within half a degree."""
    normal = np.array([0.3, -0.5, 0.81])
    normal /= np.linalg.norm(normal)
    made = RestView.made(
        np.ones((24, 32), bool), np.broadcast_to(normal, (24, 32, 3)), np.zeros((1, 2))
    )
    back = RestView.of(made.arrays())
    off = np.degrees(np.arccos(np.clip(back.normals() @ normal, -1.0, 1.0)))
    assert off.max() < 0.5


def test_the_module_for_other_programs_says_the_same() -> None:
    """Depth, force and deviation of `Predictor`, from the traced module."""
    reader = reader_file(rest=rest_view())
    rng = np.random.default_rng(0)
    idle, photo = rng.uniform(50, 200, (2, ROWS, COLUMNS, 3)).astype(np.float32)
    told = Predictor(reader).read(idle, photo[None])
    tensors = [torch.from_numpy(image).permute(2, 0, 1)[None] for image in (idle, photo)]
    with warnings.catch_warnings(), torch.inference_mode():
        warnings.simplefilter("ignore")
        traced: Any = torch.jit.trace(standalone(reader), tuple(tensors), check_trace=False)
        depth, sees, force, sigma = traced(*tensors)
    assert np.allclose(depth[0].numpy(), told.depth_mm[0], atol=1e-5)
    assert np.array_equal(sees[0].numpy(), reader.rest.sees)
    assert np.allclose(force.numpy(), told.force_N, atol=1e-5)
    assert np.allclose(sigma.numpy(), told.force_sigma_N, atol=1e-5)


def test_photographs_come_in_any_size() -> None:
    """Halved by means of areas: a checkerboard becomes its mean."""
    board = np.indices((2 * ROWS, 2 * COLUMNS)).sum(axis=0) % 2
    image = np.repeat(200 * board[:, :, None], 3, axis=2).astype(np.uint8)
    found = in_size([image], COLUMNS, ROWS)
    assert found.shape == (1, ROWS, COLUMNS, 3)
    assert np.allclose(found, 100.0)


def test_a_window_holds_what_changed_or_forgets_the_force() -> None:
    """Inputs and truth are cut alike; a contact that is too wide has no force."""
    rng = np.random.default_rng(0)
    depth = torch.zeros(2, 64, 96)
    depth[0, 20:40, 50:70] = 0.5
    depth[1, 2:60, 5:90] = 0.5
    wanted = Wanted(
        depth_mm=depth,
        surface_mm=depth,
        turn=torch.zeros(2, 3, 64, 96),
        pressure_MPa=depth,
        force_N=torch.ones(2, 3),
        solved=torch.ones(2),
    )
    enters = depth[:, None].repeat(1, INPUTS, 1, 1)
    boxes = [(20, 40, 50, 70), (2, 60, 5, 90)]
    for _ in range(20):
        parts, truth = cut_to_contact(enters, wanted, boxes, (32, 48), rng)
        assert parts.shape == (2, INPUTS, 32, 48)
        assert torch.equal(parts[:, 0], truth.depth_mm)
        assert int((truth.depth_mm[0] > 0).sum()) == 400
        assert truth.solved.tolist() == [1.0, 0.0]


def test_a_shift_moves_photographs_and_truth_alike() -> None:
    """A photograph that is its depth stays so but for its edges, and moves by some pixels."""
    depth = torch.zeros(4, 60, 80)
    depth[:, 20:40, 30:55] = 0.5
    wanted = Wanted(
        depth_mm=depth,
        surface_mm=depth,
        turn=depth[:, None].repeat(1, 3, 1, 1),
        pressure_MPa=depth,
        force_N=torch.ones(4, 3),
        solved=torch.ones(4),
    )
    photos = 200.0 * depth[:, None].repeat(1, 3, 1, 1)
    generator = torch.Generator().manual_seed(2)
    idle, moved, truth = shifted(torch.full_like(photos, 7.0), photos, wanted, generator)
    assert torch.allclose(idle, torch.tensor(7.0))
    inside = torch.isfinite(truth.depth_mm)
    assert 0.8 < float(inside.float().mean()) < 1.0
    off = (moved[:, 0] / 200.0 - truth.depth_mm)[inside].abs()
    # Only pixels on the edge of the patch are blended.
    assert float((off > 0.01).float().mean()) < 0.04
    assert torch.equal(truth.surface_mm[inside], truth.depth_mm[inside])
    middles = [
        torch.nonzero(torch.nan_to_num(each) > 0.25).float().mean(dim=0) for each in truth.depth_mm
    ]
    ways = torch.stack(middles) - torch.tensor([29.5, 42.0])
    assert 0.5 < float(ways.abs().max()) < SHIFT_PX + 1.0


def test_a_wider_box_stays_in_the_image() -> None:
    """At its upper and left edges; windows clip the others."""
    assert wider((1, 9, 20, 30), 3) == (0, 12, 17, 33)
