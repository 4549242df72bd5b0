"""The stages of fast contact, one file each, as those of `workbench.pipeline.stages`."""
