"""The network: its size, its symmetries, what is frozen, and normalisation folded away."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from torch import Tensor, nn

from sim.forces.network.folding import folded
from sim.forces.network.kernel_maps import Kernel, KernelMaps, kernel_maps
from sim.forces.network.minkunet import (
    MinkUNet,
    arrays_of,
    network_of,
    new_network,
    parameter_count,
)
from sim.forces.network.spec import PAPER, SMALL, Activation, NetworkSpec, Norm, Target
from sim.forces.network.voxels import join, voxel_edge_mm, voxelise
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.errors import DesignError, StoreError
from workbench.proof.benchmarks.forces import shell

TINY = NetworkSpec(name="tiny", planes=(4, 6, 8, 8, 8, 6, 6, 4), stem_planes=4)


def skin(points: int) -> np.ndarray:
    return shell(points)


def used(network: MinkUNet, maps: KernelMaps, features: Tensor) -> Tensor:
    """The network's output outside of training."""
    with torch.no_grad():
        return network.eval()(features, maps)


def lived_in(spec: NetworkSpec, *, dtype: torch.dtype = torch.float64) -> MinkUNet:
    """A network whose normalisations have seen data: no scale is 1 and no mean is 0."""
    network = new_network(spec, seed=3).to(dtype)
    generator = torch.Generator().manual_seed(4)
    for module in network.modules():
        if isinstance(module, nn.BatchNorm1d):
            assert module.running_mean is not None and module.running_var is not None
            for values in (module.weight, module.running_var):
                values.data.uniform_(0.5, 2.0, generator=generator)
            for values in (module.bias, module.running_mean):
                values.data.normal_(std=0.3, generator=generator)
    return network


def drawn(*shape: int) -> Tensor:
    return torch.randn(*shape, dtype=torch.float64, generator=torch.Generator().manual_seed(5))


def relative(found: Tensor, expected: Tensor) -> float:
    """Largest difference over the largest value."""
    return float((found - expected).abs().max() / expected.abs().max())


def test_published_network_has_11577475_parameters() -> None:
    """Counted in the published network; the small one is under a million."""
    assert parameter_count(new_network(PAPER)) == 11_577_475
    assert parameter_count(new_network(SMALL)) < 1_000_000


def test_every_choice_of_norm_and_activation_runs() -> None:
    """Output has a row per voxel, a column per sample and the asked channels."""
    voxels = voxelise(skin(60), voxel_mm=3.0)
    for norm in Norm:
        for activation in Activation:
            spec = NetworkSpec(
                name="tiny",
                planes=TINY.planes,
                stem_planes=4,
                stem_edge=3,
                output_channels=6,
                norm=norm,
                activation=activation,
            )
            network = new_network(spec)
            assert any(isinstance(m, nn.BatchNorm1d) for m in network.modules()) == (
                norm is not Norm.NONE
            )
            output = network(torch.randn(voxels.count, 2, 3), kernel_maps(voxels, stem_edge=3))
            assert output.shape == (voxels.count, 2, 6)


def test_same_seed_gives_the_same_network_and_leaves_other_draws_alone() -> None:
    """Equal weights bit by bit; the global generator goes on as if nothing had happened."""
    torch.manual_seed(7)
    expected = torch.rand(3)
    torch.manual_seed(7)
    one, two = new_network(TINY, seed=1), new_network(TINY, seed=1)
    assert torch.equal(torch.rand(3), expected)
    for ours, theirs in zip(one.parameters(), two.parameters(), strict=True):
        assert torch.equal(ours, theirs)


def test_pairs_and_gathering_agree() -> None:
    """Two orders of the same sums in float64, through some twenty layers."""
    points_mm = skin(300)
    voxels = voxelise(points_mm, voxel_mm=voxel_edge_mm(points_mm))
    features = drawn(voxels.count, 2, 3)
    network = lived_in(TINY)
    pairs = used(network, kernel_maps(voxels, block_voxels=64), features)
    gathered = used(network, kernel_maps(voxels, kernel=Kernel.GATHER), features)
    assert relative(pairs, gathered) < 1e-12


@pytest.mark.parametrize("kernel", Kernel)
def test_ragged_batch_equals_separate_runs(kernel: Kernel) -> None:
    """Two membranes of different size side by side, two samples each, and in training."""
    clouds = [skin(200), skin(330)]
    membranes = [voxelise(points, voxel_mm=2.0) for points in clouds]
    features = [drawn(voxels.count, 2, 3) for voxels in membranes]
    network = lived_in(TINY)
    together = used(network, kernel_maps(join(membranes), kernel=kernel), torch.cat(features))
    alone = [
        used(network, kernel_maps(voxels, kernel=kernel), own)
        for voxels, own in zip(membranes, features, strict=True)
    ]
    # float64 sums in another order of blocks.
    assert relative(together, torch.cat(alone)) < 1e-12


def test_samples_of_a_membrane_do_not_see_each_other() -> None:
    """Sample 1 of 3 equals a run of its own."""
    voxels = voxelise(skin(200), voxel_mm=2.0)
    maps = kernel_maps(voxels)
    features = drawn(voxels.count, 3, 3)
    network = lived_in(TINY)
    alone = used(network, maps, features[:, 1:2])
    assert relative(used(network, maps, features)[:, 1:2], alone) < 1e-12


def test_permuted_points_give_permuted_results() -> None:
    """From points to points, the order of the points is a matter of naming."""
    points_mm = skin(250)
    order = np.random.default_rng(6).permutation(len(points_mm))
    features, network = drawn(len(points_mm), 1, 3), lived_in(TINY)

    def run(points: np.ndarray, values: Tensor) -> Tensor:
        voxels = voxelise(points, voxel_mm=2.0)
        return voxels.to_points(used(network, kernel_maps(voxels), voxels.mean(values)))

    permuted = run(points_mm[order], features[order])
    # Means of a voxel add in another order.
    assert relative(permuted, run(points_mm, features)[order]) < 1e-12


def test_training_steps_repeat_bit_by_bit() -> None:
    """Two runs of three steps of Adam from the same seed end with the same weights."""
    voxels = voxelise(skin(200), voxel_mm=2.0)
    maps, features = kernel_maps(voxels), drawn(voxels.count, 2, 3).float()

    def trained() -> list[Tensor]:
        network = new_network(TINY, seed=2)
        optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
        for _ in range(3):
            optimiser.zero_grad()
            (network(features, maps) - features).abs().mean().backward()
            optimiser.step()
        return list(network.parameters())

    for first, second in zip(trained(), trained(), strict=True):
        assert torch.equal(first, second)


def test_network_learns_what_neighbours_do() -> None:
    """Sums over the neighbours of two samples: a hundred steps reach .42 of the zero predictor."""
    voxels = voxelise(skin(150), voxel_mm=2.5)
    maps, features = kernel_maps(voxels), drawn(voxels.count, 2, 3).float()
    wanted = torch.cat([features, torch.zeros(1, 2, 3)])[maps.levels[0].neighbours].sum(1)
    network = new_network(TINY, seed=2)
    optimiser = torch.optim.Adam(network.parameters(), lr=2e-2)
    error = torch.tensor(0.0)
    for _ in range(101):
        optimiser.zero_grad()
        error = (network(features, maps) - wanted).abs().mean()
        error.backward()
        optimiser.step()
    # Room for another CPU's rounding.
    assert float(error.detach()) < 0.6 * float(wanted.abs().mean())


def test_frozen_encoder_stays_through_training() -> None:
    """Weights and statistics of the encoder keep their bits; the decoder's change."""
    voxels = voxelise(skin(150), voxel_mm=2.5)
    maps, features = kernel_maps(voxels), drawn(voxels.count, 2, 3).float()
    network = new_network(TINY)
    network.freeze_encoder()
    before = {name: value.clone() for name, value in network.state_dict().items()}
    optimiser = torch.optim.Adam(network.decoder_parameters(), lr=1e-2)
    for _ in range(2):
        network.train()
        network(features, maps).square().sum().backward()
        optimiser.step()
    changed = {
        name.split(".")[0]
        for name, value in network.state_dict().items()
        if not torch.equal(value, before[name])
    }
    assert changed == {"ups", "decoder", "last"}


def test_decoder_and_encoder_share_all_parameters() -> None:
    """Together they are the network, and no parameter is in both."""
    network = new_network(SMALL)
    decoder = sum(parameter.numel() for parameter in network.decoder_parameters())
    encoder = sum(parameter_count(module) for module in network.encoder_modules())
    assert decoder + encoder == parameter_count(network)


@pytest.mark.parametrize("norm", Norm)
def test_folded_network_equals_the_network(norm: Norm) -> None:
    """Equal to rounding in float64, no normalisation left, and the original untouched."""
    spec = NetworkSpec(name="tiny", planes=TINY.planes, stem_planes=4, norm=norm)
    network = lived_in(spec)
    voxels = voxelise(skin(200), voxel_mm=2.0)
    maps, features = kernel_maps(voxels), drawn(voxels.count, 1, 3)
    expected = used(network, maps, features)
    inner = folded(network)
    assert relative(used(inner, maps, features), expected) < 1e-12
    assert not any(isinstance(module, nn.BatchNorm1d) for module in inner.modules())
    assert torch.equal(used(network, maps, features), expected)


def test_mixed_precision_trains() -> None:
    """Under autocast products are bfloat16, gradients float32 and of nearly the same direction."""
    voxels = voxelise(skin(150), voxel_mm=2.5)
    features = drawn(voxels.count, 2, 3).float()
    gradients = []
    for mixed in (False, True):
        network = new_network(TINY)
        with torch.autocast("cpu", torch.bfloat16, enabled=mixed):
            output = network(features, kernel_maps(voxels))
        assert output.dtype is (torch.bfloat16 if mixed else torch.float32)
        output.float().square().mean().backward()
        gradient = network.stem.weight.grad
        assert gradient is not None and gradient.dtype is torch.float32
        gradients.append(gradient.flatten())
    # bfloat16 keeps 8 bits, and some ReLU open or close; 0.99 was measured, 0 is chance.
    assert float(torch.cosine_similarity(*gradients, dim=0)) > 0.95


def weights_of(network: MinkUNet) -> NetworkWeights:
    return NetworkWeights(
        spec=network.spec,
        arrays=arrays_of(network),
        target=Target.FORCE,
        input_scale_mm=1.0,
        output_scale=(1.0, 1.0, 1.0),
        voxel_per_spacing=0.75,
        spacing_mm=1.0,
        card={},
    )


def test_weights_rebuild_the_network() -> None:
    """Every parameter and statistic comes back bit by bit."""
    network = lived_in(TINY, dtype=torch.float32)
    again = network_of(weights_of(network)).state_dict()
    for name, value in network.state_dict().items():
        assert torch.equal(again[name], value), name


def test_weights_of_another_network_are_refused() -> None:
    """A missing array is a StoreError with a remedy, no traceback of PyTorch."""
    weights = weights_of(new_network(TINY))
    assert isinstance(weights.arrays, dict)
    weights.arrays.pop("last.bias")
    with pytest.raises(StoreError, match="tiny") as caught:
        network_of(weights)
    assert caught.value.hint


def test_impossible_networks_are_refused() -> None:
    """Seven planes, a plane of no channel, an even stem."""
    for planes, edge in (((8,) * 7, 5), ((8,) * 7 + (0,), 5), ((8,) * 8, 4)):
        with pytest.raises(DesignError):
            NetworkSpec(name="bad", planes=planes, stem_planes=4, stem_edge=edge)
