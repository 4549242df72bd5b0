"""Sensors in the loops of other programs' physics: MuJoCo."""
