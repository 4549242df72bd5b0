"""Small studies of the contact solver whose exact answers are known; each returns its numbers.

Taichi must have been initialised in this thread.
"""
