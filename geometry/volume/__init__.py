"""Volume meshes: hexahedra, tetrahedra, the lattice of material points, and their quality."""
