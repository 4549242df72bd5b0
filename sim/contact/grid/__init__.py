"""The background grid: how its nodes lie in memory, and the stencil around one."""
