"""Edits: fields as typed, forms, tables of LEDs, strokes, and their undo."""
