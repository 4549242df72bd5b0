"""Designer maps: where on its skin a sensor sees, and how well."""
