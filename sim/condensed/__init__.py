"""Fast contact: a skin condensed to its nodes by finite elements, pressed by rigid poses."""
