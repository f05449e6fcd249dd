"""Show a progress bar on a terminal, or else print a line every 15 s."""

import sys
import time


class Progress:
    """Progress of `count` steps, of which `done` are complete at the start; a call adds steps."""

    def __init__(self, count, done=0):
        self.count, self.done, self.before = count, done, done
        self.begin, self.shown = time.time(), 0.0

    def __call__(self, what, steps=1):
        self.done += steps
        spent = time.time() - self.begin
        if sys.stderr.isatty():
            filled = 30 * self.done // self.count
            left = spent / (self.done - self.before) * (self.count - self.done)
            bar = "#" * filled + "." * (30 - filled)
            sys.stderr.write(f"\r[{bar}] {self.done}/{self.count}, about {left:.0f} s left  {what:50.50}")
            if self.done >= self.count:
                sys.stderr.write("\n")
        elif spent - self.shown > 15 or self.done >= self.count:
            self.shown = spent
            print(f"{self.done}/{self.count} after {spent:.0f} s  {what}", flush=True)
