"""Check the arguments of the package's functions, whose mistakes are sentences."""

import functools
import inspect
import os

from .problem import Problem
from .variables import suggestion


def _argument_message(function, signature, words, error):
    unknown = [word for word in words if word not in signature.parameters]
    if not unknown:
        return f"{function.__name__}: {error}; expected {function.__name__}{signature.replace(return_annotation=inspect.Signature.empty)}"
    known = [word for word in signature.parameters if word != "self"]
    return f"'{unknown[0]}' is not an argument of {function.__name__}; {suggestion(unknown[0], known, 'expected one of these')}"


def checked(function):
    """Return the function, with a check that raises Problem for arguments that do not fit the signature, and for a system that is not a path."""
    signature = inspect.signature(function)
    plain = signature.replace(parameters=[one.replace(annotation=inspect.Parameter.empty) for one in signature.parameters.values()])

    @functools.wraps(function)
    def call(*values, **words):
        try:
            given = signature.bind(*values, **words).arguments
        except TypeError as error:
            raise Problem(_argument_message(function, plain, words, error)) from None
        if "system" in given and not isinstance(given["system"], (str, os.PathLike)):
            raise Problem(f"the system is {given['system']!r}; expected the path of a system or of an FMU")
        return function(*values, **words)

    return call
