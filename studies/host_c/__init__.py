"""What the host in C takes of small processors: code, memory, stack, instructions an update."""
