"""The browser front: shows results and writes to the session; it never computes."""
