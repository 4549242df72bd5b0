"""A browser without a graphics card draws twice as fast, and at rest finely once, then no more.

Half of such a browser's time goes into smoothing edges, by four samples of each pixel. A script at
the head of the page asks for drawings without it, where a program draws in a card's place, and once
nothing has moved for a moment has the view drawn once more with finer pixels, which are smoother
still. While something moves pixels are as large as viser wants them; a page whose address fixes
their size (`fixedDpr`) keeps it. viser asks for smooth edges before a piece of HTML from us could
be there, so the script is laid into the page file itself.

viser also draws once a second for changes that asked for no drawing, "cheap" by its own words: by a
program that took most of a processor for a page at rest, which presses and bakes then lack. A few
seconds after the last change these drawings are left out.
"""

from __future__ import annotations

import functools
import gzip

FINE = 1.5
"""Pixels of a drawing at rest along an edge of the screen's."""
MOST = 2.0
"""Pixels along an edge of the page's, beyond which screens are fine enough themselves."""
REST_MS = 400
"""How long nothing must have moved."""
HEARTBEAT_MS = 1000
"""How often viser draws without being asked (`RENDER_HEARTBEAT_MS` of its `App.tsx`)."""
CALM_MS = 5000
"""How long it may after the last change."""
HEAD = b"<head>"
SCRIPT = (
    """
(() => {
  const real = HTMLCanvasElement.prototype.getContext;
  const byProgram = () => {
    const probe = real.call(document.createElement('canvas'), 'webgl2');
    const told = probe && probe.getExtension('WEBGL_debug_renderer_info');
    const name = told ? String(probe.getParameter(told.UNMASKED_RENDERER_WEBGL)) : '';
    const lost = probe && probe.getExtension('WEBGL_lose_context');
    if (lost) lost.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  };
  let known = null;
  HTMLCanvasElement.prototype.getContext = function (kind, wanted) {
    if (!/^webgl/.test(kind)) return real.call(this, kind, wanted);
    if (known === null) known = byProgram();
    return real.call(this, kind, known ? {...wanted, antialias: false} : wanted);
  };
  /* viser's heartbeat is a call of one function without arguments. */
  let movedAt = 0;
  const setTimer = window.setInterval;
  window.setInterval = function (call, ms, ...given) {
    const beats = ms === HEARTBEAT_MS && /^\\(\\) *=> *[\\w$]+\\(\\)$/.test(String(call));
    const calm = () => known && performance.now() - movedAt > CALM_MS;
    return setTimer.call(this, beats ? () => { if (!calm()) call(); } : call, ms, ...given);
  };

  const sized = new URLSearchParams(location.search).has('fixedDpr');
  let timer = 0, fine = false;
  const state = () => window.__viserMutable?.scene?.__r3f?.root?.getState();
  const finest = () => {
    const own = window.devicePixelRatio;
    return Math.max(own, Math.min(FINE * own, MOST));
  };
  const refine = () => {
    const now = state();
    if (document.hidden || !now) return;
    fine = true;
    now.gl.setPixelRatio(finest());
    now.invalidate();
  };
  const moves = () => {
    movedAt = performance.now();
    if (sized) return;
    clearTimeout(timer);
    timer = setTimeout(refine, REST_MS);
    const now = state();
    if (!fine || !now) return;
    fine = false;
    now.gl.setPixelRatio(now.viewport.dpr);
  };
  /* Viser makes the view anew once it was out of sight. */
  setTimer(() => {
    const seen = window.__viserMutable, now = state();
    if (!known || !now) return;
    const request = seen.requestRender, eye = seen.cameraControl;
    if (!request.told) {
      seen.requestRender = () => { moves(); request(); };
      seen.requestRender.told = true;
      moves();
    }
    if (eye && !eye.told) {
      eye.addEventListener('update', moves);
      eye.told = true;
    }
    /* Viser sets a size of its own once it has measured enough drawings, at rest too. */
    if (fine && now.gl.getPixelRatio() !== finest()) refine();
  }, 500);
})();
""".replace("HEARTBEAT_MS", str(HEARTBEAT_MS))
    .replace("CALM_MS", str(CALM_MS))
    .replace("FINE", str(FINE))
    .replace("MOST", str(MOST))
    .replace("REST_MS", str(REST_MS))
)


@functools.lru_cache(maxsize=2)
def page_with_script(page: bytes, packed: bool) -> bytes:
    """The page file with the script before all of its own.

    Args:
        page: Of viser.
        packed: Whether it is compressed by gzip, which it then is again.
    """
    text = gzip.decompress(page) if packed else page
    mended = text.replace(HEAD, HEAD + b"<script>" + SCRIPT.encode() + b"</script>", 1)
    return gzip.compress(mended) if packed else mended
