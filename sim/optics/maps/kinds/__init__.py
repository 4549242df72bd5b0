"""Maps of the skin, one file each: its name stands in files, `MAP` says what it shows."""
