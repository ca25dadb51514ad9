"""From a problem to all its solutions, and from these to one proved surface."""
