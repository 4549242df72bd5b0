"""Light models, one file each: the name of the file stands in designs, `MODEL` says the rest."""
