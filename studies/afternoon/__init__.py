"""Runs the tutorial from a preset to a bitstream, command by command, and times it."""
