"""The studio: everything that turns a pressed skin into tactile images, and their scores."""
