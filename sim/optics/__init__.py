"""From LEDs to pixels."""
