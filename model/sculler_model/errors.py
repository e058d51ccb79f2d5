"""The exceptions that mean "the user's input is at fault" and "a tool failed"."""


class Error(Exception):
    """The base of every error that sculler raises on purpose; the message is one line.

    Its kinds are `InputError` (also a ValueError), `ToolError` and, of a simulation,
    `SimulationError` (both also a RuntimeError).

    Examples:
        >>> import sculler
        >>> try:
        ...     sculler.Design.preset("no such sensor")
        ... except sculler.Error as error:
        ...     print(type(error).__name__)
        InputError
    """


class InputError(Error, ValueError):
    """Bad input from outside: a design, a log, an option.

    The message is one line that says what is wrong, where, and how to mend it.  The command line
    prints it to stderr and exits with status 2.

    Examples:
        >>> import sculler
        >>> try:
        ...     sculler.Log.of([[0, 0, 0.5, 0, 0, 0]])
        ... except sculler.InputError as error:
        ...     print(error)
        counts: 0.5 at (0, 2) is not a whole number of 64 bits, give integers
    """


class ContradictionError(InputError):
    """Arguments that do not go together, whatever the files hold; the verb's help says which do."""


class ToolError(Error, RuntimeError):
    """A program that we need failed on what should have gone well.

    The message is one line; the command line prints it and exits with status 2.

    Examples:
        >>> import sculler
        >>> issubclass(sculler.ToolError, RuntimeError)
        True
    """
