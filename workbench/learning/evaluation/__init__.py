"""How good learned forces are: scores beside nulls, pictures, rows and a report."""
