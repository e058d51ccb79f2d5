"""Compensation in exact integers, and a core behind it."""
