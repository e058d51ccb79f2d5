"""Cores that notice upsets, or recover from them: copies of a core side by side."""
