"""The variables of an FMU."""


def settable(description):
    """The names of those whose start values can be set: parameters, inputs, states."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type in ("Real", "Float64")]


def start_values(description):
    """Of all that have one, as numbers."""
    return {v.name: {"true": 1.0, "false": 0.0}[v.start] if v.type == "Boolean" else float(v.start) for v in description.modelVariables if v.start is not None}


def why_not(name, description):
    """Why it cannot be set, where that needs a word."""
    calculated = [v.name for v in description.modelVariables if v.causality == "calculatedParameter"]
    return ", as it follows from other parameters" if name in calculated else ""
