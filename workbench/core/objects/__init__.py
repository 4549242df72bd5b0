"""What an object that presses is made of: kinds, plane figures, distances in closed form."""
