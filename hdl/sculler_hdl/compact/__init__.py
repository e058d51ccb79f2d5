"""The compact core: one multiplication at a time, by a static schedule."""
