"""The schedule of the compact core: compiled, encoded, interpreted, listed."""
