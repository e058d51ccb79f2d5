"""The simulators, and the cache of what they compile."""
