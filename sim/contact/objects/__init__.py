"""Objects: shapes and their signed distances, sampled or in closed form."""
