"""The paper's fourteen indenters as released, one file each; `released_` stands before its name."""
