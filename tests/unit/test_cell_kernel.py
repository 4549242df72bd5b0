"""What the contact kernel computes by iteration, against closed forms."""

import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("taichi_device")


@pytest.mark.filterwarnings("ignore:.*Calling non-taichi function")
def test_the_inverse_cube_root_is_one_to_single_precision() -> None:
    """J^(-1/3) for volumes from 0.2 to 3: far beyond what a settled frame holds, to 1e-6.

    A step fewer would be 8e-5 off at 0.2; incompressible gel multiplies that by its bulk modulus.
    """
    import taichi as ti

    from sim.contact.engine.cell_kernel import _inverse_cube_root

    @ti.kernel
    def roots(ratio: ti.types.ndarray(), out: ti.types.ndarray()):  # pyright: ignore
        # Taichi reads these annotations, so they may not be put off to the future.
        for i in range(ratio.shape[0]):
            out[i] = _inverse_cube_root(ratio[i])

    ratio = np.geomspace(0.2, 3.0, 2000).astype(np.float32)
    found = np.empty_like(ratio)
    roots(ratio, found)
    np.testing.assert_allclose(found, ratio.astype(np.float64) ** (-1.0 / 3.0), rtol=1e-6)
