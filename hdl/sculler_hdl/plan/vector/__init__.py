"""What the vector engine of the pipelined core does: the terms of third and fourth order."""
