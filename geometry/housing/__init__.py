"""What carries the membrane: camera mount, LED holder, base and actuators."""
