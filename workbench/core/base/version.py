"""The version of the workbench, which kept designs and reports name."""

VERSION = "0.1.0"
