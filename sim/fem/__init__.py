"""Finite elements: the quasi-static ground truth that the fast solvers are judged by."""
