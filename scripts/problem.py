"""What went wrong in a way that the user can do something about."""


class Problem(Exception):
    """Its text is the message, with the remedy."""


class Unfinished(Problem):
    """A simulation that stopped; has the Motion until then as `motion`."""

    def __init__(self, text, motion):
        super().__init__(text)
        self.motion = motion
