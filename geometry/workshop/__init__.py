"""What is handed to the workshop: STL, STEP and 3MF files, build sheet, recipe, parts list."""
