"""Contact, light and their measures."""
