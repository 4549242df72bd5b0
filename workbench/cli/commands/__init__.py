"""Commands, one file each: `workbench NAME`, or `workbench GROUP NAME` of the file `group_name`."""
