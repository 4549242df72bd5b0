"""What viser has no widget or setting for: scripts and a style sheet, each with its reason.

All come into the page as HTML, which viser shows as it is; none changes viser's own files.
"""
