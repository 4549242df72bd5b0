"""What is pressed and how it is computed: object, motion, settings of the solvers."""
