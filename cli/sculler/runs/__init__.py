"""What the verbs do, as functions and classes without a command line."""
