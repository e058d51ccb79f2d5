"""The one exception that means "the user's input is at fault"."""


class InputError(ValueError):
    """Bad input from outside: a design, a log, an option.

    The message is one line that says what is wrong, where, and how to mend it.  The command line
    prints it to stderr and exits with status 2.
    """
