"""What a designer decides: shape, layers, material, lights, cameras, how it is made."""
