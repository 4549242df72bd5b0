"""A finite-element solver of its own for presses that are bodies of revolution, for tests alone.

It shares no code with `sim.fem`, and finds the limits that `sim.fem` is judged by: `grids` has
the sections, `solid` the elements, `profiles` the rigid objects, `contact` their touch, `solving`
Newton's method, `cases` the presses, `limits` what they tend to, and
`python -m tests.reference.axisymmetric` writes the record anew.
"""
