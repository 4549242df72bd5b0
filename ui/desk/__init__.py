"""A session's state, and what follows it: jobs, live press, previews, saving."""
