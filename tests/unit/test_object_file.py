"""Uploaded objects that a worker reads."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.live.object_file import ObjectFile
from workbench.pipeline.store import Store
from workbench.system.uploads import MOST_BYTES

CUBE = b"""v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


def test_an_object_comes_back_from_the_worker_as_it_is_in_the_file(tmp_path: Path) -> None:
    """A cube of 2 mm, through the pickles of both ways."""
    call = pickle.loads(pickle.dumps(ObjectFile(name="my cube.obj", content=CUBE)))
    assert (call.lane, call.needs) == ("look", ())
    found = pickle.loads(pickle.dumps(call.answer(Store(tmp_path), {}, silent)))
    assert found.size_mm == 2.0
    assert np.ptp(found.mesh.points_mm, axis=0).tolist() == [2.0, 2.0, 2.0]


def test_a_file_that_is_too_large_is_not_sent() -> None:
    """It is refused by the widget's callback, with its size and the limit."""
    with pytest.raises(DesignError, match="the browser takes 40 MB"):
        ObjectFile(name="big.stl", content=bytes(MOST_BYTES + 1))
