"""Doubts about data: breaks, odd counts, odd stamps, what gravity says of the axes."""
