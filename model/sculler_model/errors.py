"""The exceptions that mean "the user's input is at fault" and "a tool failed"."""


class InputError(ValueError):
    """Bad input from outside: a design, a log, an option.

    The message is one line that says what is wrong, where, and how to mend it.  The command line
    prints it to stderr and exits with status 2.
    """


class ContradictionError(InputError):
    """Arguments that do not go together, whatever the files hold; the verb's help says which do."""


class ToolError(RuntimeError):
    """A program that we need failed on what should have gone well.

    The message is one line; the command line prints it and exits with status 2.
    """
