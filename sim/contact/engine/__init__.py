"""Dynamic relaxation on the device: tables, kernels, their plain twins."""
