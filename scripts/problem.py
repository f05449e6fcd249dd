"""What went wrong in a way that the user can do something about."""


class Problem(Exception):
    """Its text is the message, with the remedy."""
