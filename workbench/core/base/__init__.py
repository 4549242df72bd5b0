"""Ground of everything: errors, units, keys, tables, poses, progress."""
