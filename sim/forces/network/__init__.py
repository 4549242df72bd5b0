"""The sparse tensor network: from the displacement of a skin to forces, displacements or stress.

A membrane's points fall into voxels once (`voxels`); where each voxel's neighbours lie is found
once (`levels`, `kernel_maps`) and cached by the caller. A frame is then gathers and matrix products
(`convolution`, `strided`) in the layers of a U-Net (`layers`, `minkunet`), on any device of
PyTorch. `reference` is the dense twin, `predictor` runs a trained network on a whole skin,
`patches` one that looks at the surroundings of the contact alone, turned (`turns`) and found anew
for each frame, on a GPU in one launch (`recorded_patches`, `fixed_maps`); `steady` chooses.
`weights` keeps a network.

A skin fills a fiftieth of its box and a voxel has 6 to 13 of 27 neighbours: `products` multiplies
the pairs that exist (CPU) or copies neighbours side by side (GPU). Tables are symmetric, so
gradients gather as well, nothing scatters, and runs repeat bit by bit.

`spec` and `weights` do without PyTorch; the other modules import it at their top, so nothing
outside this package may import them at module level. Training, data sets and scores are not here.

Source: C. Choy, J. Gwak, S. Savarese, "4D Spatio-Temporal ConvNets: Minkowski Convolutional Neural
Networks", CVPR 2019, for the network and the meaning of a sparse convolution.
"""
