"""One file for each task: what is pressed, what is told from the images, by what it is judged."""
