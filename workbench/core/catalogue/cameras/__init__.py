"""Camera modules, one file each: its name chooses it, `CAMERA` says the rest."""
