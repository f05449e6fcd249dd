"""Check the arguments of the package's functions, whose mistakes are sentences."""

import functools
import inspect
import math
import os
from numbers import Integral, Real

from .problem import Problem
from .quantities import number_of
from .variables import suggestion

SECONDS = ("start_time", "stop_time", "step")
PATHS = ("folder", "output", "path")  # arguments that are paths of files or folders; those of simulate() are names
NUMBERS = ("tolerance", "random", "seed", "fmi")


def _argument_message(function, signature, words, error):
    unknown = [word for word in words if word not in signature.parameters]
    if not unknown:
        return f"{function.__name__}: {error}; expected {function.__name__}{signature.replace(return_annotation=inspect.Signature.empty)}"
    known = [word for word in signature.parameters if word != "self"]
    return f"'{unknown[0]}' is not an argument of {function.__name__}; {suggestion(unknown[0], known, 'expected one of these')}"


def _is_number(value):
    return isinstance(value, Real) and not isinstance(value, bool)


def _text_of(annotation):
    return annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)


def _checked_value(name, value, annotation):
    """Return the value of an argument, with a time as a number; raise Problem if it has the wrong type."""
    if name == "system" and not isinstance(value, (str, os.PathLike)):
        raise Problem(f"the system is {value!r}; expected the path of a system or of an FMU")
    if value is None:
        return None
    if name in SECONDS:
        value = number_of(name, value, "s")
        if not _is_number(value):
            raise Problem(f"{name} is {value!r}; expected a number of seconds, or a text such as '3s'")
        if not math.isfinite(value):
            raise Problem(f"{name} is {value!r}; expected a finite number of seconds")
    if name in NUMBERS and not _is_number(value):
        raise Problem(f"{name} is {value!r}; expected a number")
    if name == "tolerance" and not 0 < value < 1:
        raise Problem(f"the tolerance is {value!r}; expected one between 0 and 1")
    if annotation in ("str", "str | None") and not isinstance(value, str):
        raise Problem(f"{name} is {value!r}; expected a text")
    if annotation == "bool" and not isinstance(value, Integral):
        raise Problem(f"{name} is {value!r}; expected True or False")
    if name in PATHS and "PathLike" in annotation and not isinstance(value, (str, os.PathLike)):
        raise Problem(f"{name} is {value!r}; expected a path")
    return value


def checked(function):
    """
    Return the function with a check of its arguments. It raises Problem for arguments that do not fit the signature, and for wrong types of paths,
    times or numbers.
    """
    signature = inspect.signature(function)
    plain = signature.replace(parameters=[one.replace(annotation=inspect.Parameter.empty) for one in signature.parameters.values()])

    @functools.wraps(function)
    def call(*values, **words):
        try:
            given = signature.bind(*values, **words)
        except TypeError as error:
            raise Problem(_argument_message(function, plain, words, error)) from None
        for name, value in given.arguments.items():
            parameter = signature.parameters[name]
            if parameter.kind is parameter.VAR_KEYWORD and _text_of(parameter.annotation) == "Any":
                given.arguments[name] = {word: _checked_value(word, one, "") for word, one in value.items()}
            elif parameter.kind is not parameter.VAR_KEYWORD:  # start values by name
                given.arguments[name] = _checked_value(name, value, _text_of(parameter.annotation))
        return function(*given.args, **given.kwargs)

    return call
