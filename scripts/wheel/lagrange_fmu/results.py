"""What a simulation returns."""

from __future__ import annotations

import html
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .whole_files import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Animation:
    """A page that plays a motion in any browser, and in Jupyter; `page` is its text."""

    def __init__(self, page: str):
        self.page = page

    def save(self, path: str | os.PathLike[str]) -> Path:
        return write_whole(path, self.page)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.page)}" style="width: 100%; height: 560px; border: 1px solid #8884"></iframe>'


class Result(np.ndarray):
    """A structured array: result["time"], in s, and result[NAME], in the units of `description`; a picture of itself in Jupyter."""

    description: Any  # FMPy's ModelDescription; None where it is no whole motion
    motion: Any  # all that was simulated, likewise

    @classmethod
    def of(cls, motion: Any) -> Result:
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
        found = super().__getitem__(key)
        return found.view(np.ndarray) if isinstance(key, str) else found

    def plot(self) -> Figure:
        """A figure of matplotlib with an axis for each unit, which Jupyter shows; needs pip install lagrange-fmu[plot]."""
        from .problem import Problem
        from .simulation import event_times, figure_of

        times = event_times(self.motion.values)
        try:
            return figure_of(self.description, self, [time for time in times if self["time"][0] <= time <= self["time"][-1]])
        except ModuleNotFoundError:
            raise Problem("matplotlib is not installed; it comes with pip install matplotlib") from None

    def animate(self) -> Animation:
        """The whole motion as a page, which Jupyter shows; save(PATH) writes it for any browser."""
        from .live_page.description import scene_of
        from .live_page.page import page_of_motion
        from .problem import Problem

        if not scene_of(self.motion.tree):
            raise Problem(f"{self.description.modelName} has no particles, bodies, frames or points to be drawn; expected some in the system")
        return Animation(page_of_motion(self.motion.tree, self.motion.values, self.motion.start))

    def to_pandas(self) -> Any:
        """A DataFrame with time, in s, as its index; needs pip install pandas."""
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
