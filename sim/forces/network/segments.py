"""Sums of rows by group in a fixed order: the same bits at every run and for every thread count.

A scatter-add on a GPU adds in the order in which threads arrive. Here rows are listed by group
once, and each group is summed along its list.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import embedding_bag


@dataclass(frozen=True, kw_only=True, slots=True)
class Segments:
    """Rows listed by group."""

    order: Tensor
    """Numbers of the rows, group after group, shape (R,), int64."""
    starts: Tensor
    """Where each group's list begins in `order`, and the end of the last, shape (G + 1,)."""

    def to(self, device: str | torch.device) -> Segments:
        """The same on another device."""
        return Segments(order=self.order.to(device), starts=self.starts.to(device))


def segments(group: Tensor, *, count: int) -> Segments:
    """The lists of `count` groups from the group of each row, shape (R,), int64."""
    ends = torch.bincount(group, minlength=count).cumsum(0)
    return Segments(order=group.argsort(stable=True), starts=torch.cat([ends.new_zeros(1), ends]))


def segment_sum(rows: Tensor, lists: Segments) -> Tensor:
    """Sum of the rows of each group, shape (G, W) from (R, W); 0 for an empty group."""
    return embedding_bag(lists.order, rows, lists.starts, mode="sum", include_last_offset=True)
