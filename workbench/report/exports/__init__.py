"""What `workbench export` writes, one file each: its files, their stages, the option."""
