"""A data set in the format of LeRobot, for those who learn with it."""
