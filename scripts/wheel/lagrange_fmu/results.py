"""Hold the result of a simulation, with its plot, animation and table."""

from __future__ import annotations

import html
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .problem import Problem
from .variables import suggestion
from .whole_files import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Animation:
    """A page that plays a motion in any browser and in Jupyter; `page` is its HTML."""

    def __init__(self, page: str):
        self.page = page

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page and return its path."""
        return write_whole(path, self.page)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.page)}" style="width: 100%; height: 560px; border: 1px solid #8884"></iframe>'


class Result(np.ndarray):
    """
    A structured array with the fields "time", in s, and the recorded variables, in the units of `description`.

    result[NAME] is a plain NumPy array. Jupyter shows the result as a plot.
    """

    description: Any  # ModelDescription of FMPy; None if the array is not made of a motion
    motion: Any  # the simulation.Motion, or None

    @classmethod
    def of(cls, motion: Any) -> Result:
        """Return the Result of a simulation.Motion."""
        result = motion.outputs.view(cls)
        result.description, result.motion = motion.description, motion
        return result

    def __array_finalize__(self, source: Any) -> None:
        self.description, self.motion = (getattr(source, name, None) for name in ("description", "motion"))

    def __reduce__(self) -> Any:
        function, arguments, state = super().__reduce__()
        return function, arguments, (state, self.description, self.motion)

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state[0])
        self.description, self.motion = state[1:]

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str) and key not in (self.dtype.names or ()):
            raise Problem(f"'{key}' is not recorded; {suggestion(key, self.dtype.names or (), 'recorded are')}")
        found = super().__getitem__(key)
        return found.view(np.ndarray) if isinstance(key, str) else found

    def plot(self) -> Figure:
        """
        Plot all variables over time, with a panel for each unit and size.

        Returns
        -------
        matplotlib.figure.Figure
            Jupyter shows it.

        Raises
        ------
        Problem
            If matplotlib is not installed.

        Examples
        --------
        >>> motion.plot().savefig("motion.png")
        """
        from .problem import Problem
        from .simulation import event_times, figure_of

        times = event_times(self.motion.values)
        try:
            return figure_of(self.description, self, [time for time in times if self["time"][0] <= time <= self["time"][-1]])
        except ModuleNotFoundError:
            raise Problem("matplotlib is not installed; it comes with pip install matplotlib") from None

    def animate(self) -> Animation:
        """
        Return a page that plays the whole motion.

        Returns
        -------
        Animation
            Jupyter shows it; save(PATH) writes it for any browser.

        Raises
        ------
        Problem
            If the system has no particles, bodies, frames or points.

        Examples
        --------
        >>> motion.animate().save("motion.html")
        """
        from .live_page.description import scene_of
        from .live_page.page import page_of_motion
        from .problem import Problem

        if not scene_of(self.motion.tree):
            raise Problem(f"{self.description.modelName} has no particles, bodies, frames or points to draw; expected some in the system")
        return Animation(page_of_motion(self.motion.tree, self.motion.values, self.motion.start))

    def to_pandas(self) -> Any:
        """
        Return a DataFrame with the time, in s, as its index.

        Returns
        -------
        pandas.DataFrame
            A column for each variable.

        Raises
        ------
        Problem
            If pandas is not installed.

        Examples
        --------
        >>> motion.to_pandas()["theta"].max()
        """
        from .problem import Problem

        try:
            import pandas
        except ModuleNotFoundError:
            raise Problem("pandas is not installed; it comes with pip install pandas") from None
        return pandas.DataFrame({name: self[name] for name in self.dtype.names}).set_index("time")

    def _repr_png_(self) -> bytes | None:
        from .problem import Problem

        if self.description is None or self.ndim != 1:
            return None
        try:
            return self.plot()._repr_png_()
        except Problem:
            return None
