"""The paper's networks: those of ImageNet by their sizes, and trainings of both on tiny images."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import torch

from workbench.core.base.monitor import silent
from workbench.tasks import trained
from workbench.tasks.examples import Examples
from workbench.tasks.networks import published
from workbench.tasks.networks.imagenet import ResNet50, Vgg19
from workbench.tasks.splits import Parts
from workbench.tasks.task import Look, Net, task_of
from workbench.tasks.trained import Trainer

PARTS = Parts(np.arange(6), np.arange(6, 8), np.arange(8, 10))


@pytest.fixture
def at_random(monkeypatch: pytest.MonkeyPatch) -> None:
    """No weights are fetched, and one epoch is enough."""
    monkeypatch.setattr(published, "_weights", lambda address: None)
    once = {(Net.PAPER, look): (1, 1e-4, 4, 0.0) for look in Look}
    monkeypatch.setattr(trained, "SETTINGS", trained.SETTINGS | once)
    monkeypatch.setattr(trained, "PAPER_CLASS_EPOCHS", 1)


def noise(frames: int) -> Examples:
    """Ten examples of nothing, of two classes."""
    rng = np.random.default_rng(0)
    return Examples(
        names=tuple(map(str, range(10))),
        places=np.arange(10).astype(str),
        inputs=rng.integers(-99, 99, (10, frames, 32, 40, 3)).astype(np.int16),
        at=np.zeros((10, 8), np.float32),
        feet_mm=np.zeros((10, 3)),
        axes=np.tile(np.eye(3), (10, 1, 1)),
        motion=np.zeros(10),
        truth=np.arange(10) % 2,
        outputs=("hold", "slip"),
    )


def learned(folder: Path, name: str, found: Examples) -> trained.Trained:
    teacher = Trainer(task=task_of(name), net=Net.PAPER, folder=folder, safety=None, device="cpu")
    return teacher.trained("net", found, PARTS, 0, silent)


@pytest.mark.parametrize(("network", "numbers"), [(ResNet50, 25_557_032), (Vgg19, 143_678_248)])
def test_networks_have_as_many_numbers_as_those_of_torchvision(
    network: type[torch.nn.Module], numbers: int
) -> None:
    """Counts of its models `resnet50` and `vgg19_bn`. Source: its table of weights."""
    with torch.device("meta"):
        assert sum(each.numel() for each in network().parameters()) == numbers


def test_weights_of_another_file_are_taken_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each number of the file stands in the network; the last layer is one's own."""
    torch.manual_seed(1)
    kept = ResNet50().state_dict()
    monkeypatch.setattr(published, "_weights", lambda address: kept)
    network = published.ResNet(3)
    assert network.weights_from == published.IMAGENET
    assert torch.equal(network.backbone.conv1.weight, kept["conv1.weight"])
    assert network.backbone.fc.out_features == 3


def test_a_file_that_cannot_be_had_leaves_random_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine without a way to the net."""

    def unreachable(*given: object, **how: object) -> None:
        raise OSError("no way")

    monkeypatch.setattr(torch.hub, "load_state_dict_from_url", unreachable)
    assert published.pretrained(ResNet50()) == published.RANDOM


def test_the_papers_network_of_images_learns_and_is_kept(tmp_path: Path, at_random: None) -> None:
    """One epoch changes its weights; read again it says the same."""
    found = noise(1)
    told = dataclasses.replace(found, outputs=("cube", "sphere"))
    first = learned(tmp_path, "objects", told)
    torch.manual_seed(0)
    fresh = published.ResNet(2)
    assert not torch.equal(fresh.backbone.conv1.weight, first.network.backbone.conv1.weight)  # pyright: ignore[reportAttributeAccessIssue, reportArgumentType]
    again = learned(tmp_path, "objects", told)
    assert first.weights_from == published.RANDOM and len(first.curve) == 1
    assert (again.told(told) == first.told(told)).all()


@pytest.mark.slow
def test_the_papers_network_of_windows_learns(tmp_path: Path, at_random: None) -> None:
    """Eight images each; it tells one of both classes of every window."""
    found = noise(8)
    told = learned(tmp_path, "slip", found).told(found)
    assert told.shape == (10,) and set(told) <= {0, 1}
