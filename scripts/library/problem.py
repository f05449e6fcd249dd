"""Define the exceptions for errors that a user can correct."""


class Problem(Exception):
    """An error that a user can correct; its text names the cause and the remedy."""


class Unfinished(Problem):
    """A simulation stopped before its end; `motion` is the simulation.Motion until then."""

    def __init__(self, text, motion):
        super().__init__(text)
        self.motion = motion
