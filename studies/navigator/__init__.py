"""What the navigator ends with over a truth that shares no code with it."""
