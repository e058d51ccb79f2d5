"""Pictures (matplotlib), a module for each kind of result."""
