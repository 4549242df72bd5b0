"""How good learned forces are: scores beside nulls, sheets, rows and a report."""
