"""Learned readers of touch: their training data, made from a design, and their training."""
