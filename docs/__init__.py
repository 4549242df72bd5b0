"""Pages of the manual, and the programs that write or draw what is made from the product."""
