"""The exceptions that mean "the user's input is at fault" and "a tool failed"."""


class InputError(ValueError):
    """Bad input from outside: a design, a log, an option.

    The message is one line that says what is wrong, where, and how to mend it.  The command line
    prints it to stderr and exits with status 2.
    """


class ToolError(RuntimeError):
    """A program that we need failed on what should have gone well.

    The message is one line; the command line prints it and exits with status 2.
    """
