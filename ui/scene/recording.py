"""Records the 3D scene and the frames of a press for a file that plays without the workbench.

viser's serializer begins with all that the tabs show. The steps of the playback go into the
serializer alone: they are never sent, so no tab sees a frame move. What is written is that of
viser 1.1: `_insert_message` is not part of its public face, and sending instead would flicker.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ui.scene.scene import Scene

FRAME_S = 0.2
"""Time between frames of the file at speed 1 [s]."""
PAUSE_S = 1.0
"""How long the last frame stands before the file begins again [s]."""
MOST_FRAMES = 60
"""Of a longer press every second, third, ... frame is kept, so that the file stays small."""


def record(server: Any, scene: Scene, client: Any) -> Any:
    """viser's serializer of the scene as the tab sees it, then of the frames of the press."""
    frames = kept_frames(scene.pressed.count)
    playing = bool(frames) and not scene.hidden and not scene.map.on
    # Frames that were not made yet come before the snapshot, hidden.
    names = {k: scene.pressed.name_of(k) for k in frames} if playing else {}
    serializer = server.get_scene_serializer()
    _look(serializer, client)
    if playing:
        for name in scene.resting_nodes():
            _show(serializer, name, False)
        for k in frames:
            for number, name in names.items():
                _show(serializer, name, number == k)
            _pose(serializer, scene, k)
            _caps(serializer, scene, k)
            serializer.insert_sleep(FRAME_S)
        serializer.insert_sleep(PAUSE_S)
    return serializer


def kept_frames(count: int) -> list[int]:
    """Numbers of the frames that a file keeps, counted from 1, the last one among them."""
    step = max(1, -(-count // MOST_FRAMES))
    return list(range(count, 0, -step))[::-1]


def _look(serializer: Any, client: Any) -> None:
    from viser import _messages

    camera = client.camera
    place = tuple(float(c) for c in camera.position)
    middle = tuple(float(c) for c in camera.look_at)
    for message in (
        _messages.SetCameraPositionMessage(place, initial=True),  # pyright: ignore[reportArgumentType]
        _messages.SetCameraLookAtMessage(middle, initial=True),  # pyright: ignore[reportArgumentType]
    ):
        serializer._insert_message(message)


def _show(serializer: Any, name: str, visible: bool) -> None:
    from viser import _messages

    serializer._insert_message(_messages.SetSceneNodeVisibilityMessage(name, visible))


def _pose(serializer: Any, scene: Scene, frame: int) -> None:
    """Put the object where the frame has it."""
    from viser import _messages

    contact = scene.pressed.contact
    if scene.object.node is not None and contact is not None:
        x, y, z, *wxyz = (float(c) for c in contact.indenter_pose[frame - 1])
        name = scene.object.node.name
        serializer._insert_message(_messages.SetPositionMessage(name, (x, y, z)))
        serializer._insert_message(_messages.SetOrientationMessage(name, tuple(wxyz)))  # pyright: ignore[reportArgumentType]


def _caps(serializer: Any, scene: Scene, frame: int) -> None:
    """The cut of the membrane follows the press."""
    from viser import _messages

    found = scene.section.membrane_cap(frame)
    if found is not None:
        name, vertices, faces = found
        updates = {"vertices": vertices, "faces": faces}
        serializer._insert_message(_messages.SceneNodeUpdateMessage(name, updates))
