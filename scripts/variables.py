"""The variables of an FMU."""


def settable(description):
    """The names of those whose start values can be set: parameters, inputs, states."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type == "Real"]
