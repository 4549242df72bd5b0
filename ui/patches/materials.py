"""How rough, metallic and bright under the lamps the surfaces of the 3D view are, by their names.

A mesh of viser is chalk: its roughness is 1 and cannot be set, and a GLB, which may have any
material, is read anew at each change of a shape and is gone meanwhile. A script sets what viser
leaves alone on the materials that are there, which costs the renderer nothing, and again once viser
makes a material anew. It reaches them through `__viserMutable`, which viser shows for tests: where
that is missing, surfaces stay chalk.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from ui.patches.image_click import script_in_html

AGAIN_MS = 300
"""Time between two looks for materials that viser has made anew."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Finish:
    """A finish of a surface, each as three.js has it."""

    roughness: float
    """0 is a mirror, 1 is chalk."""
    metalness: float = 0.0
    """0 is plastic, 1 is metal."""
    reflection: float = 1.0
    """How bright the room is reflected; clear bodies are drawn with little opacity, which weakens
    their reflections as well, and have more."""
    glow: float = 0.0
    """How bright it shines by itself, in its own colour."""


# Found by eye, not measured: what a coating inside does to light is the business of the optics.
SILICONE = Finish(roughness=0.5)
"""Matt and soft, with a wide highlight; frames of a press have it in their files (`MATT`)."""
RESIN = Finish(roughness=0.15, reflection=5.0)
"""Clear and polished."""
ANODISED = Finish(roughness=0.45, metalness=0.3)
PLASTIC = Finish(roughness=0.3)
LIT = Finish(roughness=0.3, glow=0.85)
GLASS = Finish(roughness=0.12)
FINISHES = {
    "/sensor/skin": SILICONE,
    "/sensor/inside": PLASTIC,
    "/sensor/tips": PLASTIC,
    "/sensor/rigid": RESIN,
    "/sensor/foot": ANODISED,
    "/indenter": PLASTIC,
    "/parts": PLASTIC,
    "/leds/": LIT,
    "/lamps/": LIT,
    "/camera": GLASS,
}
APPLY = """
clearInterval(window.finishTimer);
window.finishTimer = setInterval(() => {
  const seen = window.__viserMutable;
  if (!seen || document.hidden) return;
  let changed = false;
  for (const [name, node] of Object.entries(seen.nodeRefFromName)) {
    const found = FINISHES.find(([prefix]) => name.startsWith(prefix));
    if (!found || !node) continue;
    for (const mesh of [node, ...node.children]) {
      const material = mesh.isMesh && mesh.material;
      if (!material || material.roughness === undefined) continue;
      const {roughness, metalness, reflection, glow} = found[1];
      const room = reflection === 1 ? null : seen.scene.environment;
      if (material.roughness === roughness && material.envMap === room
          && (!glow || material.emissive.equals(material.color))) continue;
      if (material.envMap !== room) material.needsUpdate = true;
      Object.assign(material, {roughness, metalness, envMap: room, envMapIntensity: reflection});
      if (glow) material.emissive.copy(material.color);
      if (glow) material.emissiveIntensity = glow;
      if (room) material.envMapRotation.copy(seen.scene.environmentRotation);
      changed = true;
    }
  }
  if (changed) seen.requestRender();
}, AGAIN);
"""


def finish(finishes: Mapping[str, Finish] = FINISHES) -> str:
    """HTML that gives nodes whose names begin with a prefix its finish; the first prefix counts."""
    told = json.dumps([[prefix, asdict(each)] for prefix, each in finishes.items()])
    script = APPLY.replace("FINISHES", told).replace("AGAIN", str(AGAIN_MS))
    return script_in_html(script)
