"""Quasi-static contact by a cell-wise total-Lagrangian material point method."""
