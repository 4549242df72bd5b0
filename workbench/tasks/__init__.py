"""What a design can tell apart by touch: tasks learned from renders, tested on what looks real."""
