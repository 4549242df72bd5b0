"""What Taichi reads of the sources of kernels is read once, so that they open sooner.

Functions are set in line in a kernel. At each of their calls Taichi 1.7 asks Python anew for the
lines of the function, which splits the whole file into words, and it draws every expression's place
for a message that is seldom shown. The same lines come by hundreds of times, so both are
remembered. Kernels and messages are the same as without it.
"""

from __future__ import annotations

import functools
import textwrap

REMEMBERED = 8192
"""Lines whose wrapped form is kept, some 2 MB."""


@functools.lru_cache(REMEMBERED)
def _wrapped(text: str, width: int) -> tuple[str, ...]:
    return tuple(textwrap.wrap(text, width))


class RememberedWrapper(textwrap.TextWrapper):
    """A wrapper of plain width that breaks each line of text once."""

    def wrap(self, text: str) -> list[str]:
        """The text in lines of at most `width` letters."""
        return list(_wrapped(text, self.width))


def remember_sources() -> None:
    """Let Taichi read each source once in this process; a second call changes nothing."""
    from taichi.lang import kernel_impl
    from taichi.lang.ast import ast_transformer_utils

    ast_transformer_utils.TextWrapper = RememberedWrapper  # pyright: ignore
    for name in ("getsourcelines", "getsourcefile"):
        read = getattr(kernel_impl, name)
        if not hasattr(read, "cache_info"):
            setattr(kernel_impl, name, functools.cache(read))
