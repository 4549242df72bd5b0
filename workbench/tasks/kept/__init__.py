"""What a task keeps of what it did, so that who was stopped goes on."""
