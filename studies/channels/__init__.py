"""One core for many sensors: what it takes of a device, and how many samples it serves."""
