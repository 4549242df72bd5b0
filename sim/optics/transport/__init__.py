"""Light carried by traced photons, from the lights through the clear solid to the coated skin."""
