"""What is measured: validation against references, and benchmarks."""
