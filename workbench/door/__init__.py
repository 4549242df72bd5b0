"""What `import workbench` offers: designs, presses, results, sweeps and comparisons from Python."""
