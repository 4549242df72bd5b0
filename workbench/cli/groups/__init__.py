"""Commands of two words, and the groups that share the first: one file each."""
