"""A foreign log converted: from a plan to an integer log and an `Outcome`."""
