"""What the camera of a design sees of its skin at rest, by its rays alone: no light is needed."""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.reading.network.rest_view import RestView
from sim.reading.network.spec import ReaderSpec
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh


def rest_view(mesh: MembraneMesh, optics: Optics, spec: ReaderSpec) -> RestView:
    """The skin at rest in a network's size.

    Raises:
        DesignError: If the camera is outside the cavity.
    """
    from sim.optics.light.places import camera_field, check_camera
    from sim.optics.raster.skin_view import open_skin_view

    own = optics.camera
    check_camera(mesh, own, at=camera_field(optics, own))
    camera = dataclasses.replace(own, width_px=spec.columns, height_px=spec.rows)
    view = open_skin_view(mesh, camera, index=optics.refractive_index)
    sees = (np.diff(view.layer_start) > 0) & (view.transmittance > 0.0)
    first = view.layer_start[:-1][sees]
    corners = view.faces[view.layer_face[first]]
    normals = np.zeros((len(sees), 3))
    weights = view.layer_weights[first]
    normals[sees] = -np.einsum("pk,pkc->pc", weights, view.normals[corners])
    shape = (spec.rows, spec.columns)
    places = view.start_pixel + 0.5 - view.pad_px
    inside = view.visible & (places >= 0.0).all(axis=1)
    inside &= (places <= [spec.columns, spec.rows]).all(axis=1)
    return RestView.made(
        sees.reshape(shape),
        normals.reshape(*shape, 3),
        np.where(inside[:, None], places, np.nan),
    )
