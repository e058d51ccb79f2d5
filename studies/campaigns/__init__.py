"""How long campaigns take, and what more workers are worth: `python -m studies.campaigns`."""
