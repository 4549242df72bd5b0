"""Fast contact beside the contact solver: forces, shear, images."""
