"""Training of the sparse tensor network: arrays in, a network out. No files, no data sets.

`settings` says how (and has the presets), `fields` holds what is learned from, `feeds` brings
samples together as batches, of whole skins in several orientations (`frames`) or of patches,
`trainer` goes through the epochs, `scores` measures. What a training keeps of its data and writes
to disk is in `workbench/learning/training`.

`settings` does without PyTorch; the other modules import it at their top, so nothing outside this
package may import them at module level.
"""
