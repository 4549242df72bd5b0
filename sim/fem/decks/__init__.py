"""Decks: a press as CalculiX reads it, and what another program found for it."""
