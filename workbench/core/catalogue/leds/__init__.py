"""LEDs, one file each: its name chooses it, `LED` says the rest."""
