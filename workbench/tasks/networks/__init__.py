"""Networks of the tasks, and how they learn; they need PyTorch."""
