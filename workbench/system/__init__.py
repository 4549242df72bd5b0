"""Files, folders, processes and the terminal of the machine."""
