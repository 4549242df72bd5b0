"""The application: stages, pipeline, lanes, store and command line of the sensor workbench."""

__version__ = "0.1.0"
