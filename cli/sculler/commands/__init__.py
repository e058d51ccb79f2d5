"""One module per verb; each has its click command as `command`."""
