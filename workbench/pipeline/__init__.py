"""From a design and a press to every result: stages, their keys, the store that keeps them."""
