"""The variables of an FMU."""


def settable(description):
    """The names of those whose start values can be set: parameters, inputs, states."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type == "Real"]


def why_not(name, description):
    """Why it cannot be set, where that needs a word."""
    calculated = [v.name for v in description.modelVariables if v.causality == "calculatedParameter"]
    return ", as it follows from other parameters" if name in calculated else ""
