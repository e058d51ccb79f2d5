"""Studies that write pages of docs/ or measure speeds; not part of the installed package."""
