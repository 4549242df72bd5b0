"""`workbench validate optics`: light and images beside closed forms, photons and Mitsuba."""
