"""Turns single bits of running cores over and tells what came of it; writes the page on it."""
