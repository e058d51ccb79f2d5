"""What is proved of the cores: `python -m studies.prove` (or `make prove`).

Writes the page proof.md: every claim on every shape, proved for ever, held for so many clocks, or
not, with the times.
"""
