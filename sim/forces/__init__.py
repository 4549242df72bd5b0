"""Force fields of a membrane from the displacement of its skin."""
