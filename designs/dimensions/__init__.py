"""Where the main sizes of each family stand on its body: a file for each family, of its name."""
