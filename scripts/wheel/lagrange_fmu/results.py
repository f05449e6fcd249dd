"""What a simulation returns."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Result(np.ndarray):
    """A structured array: result["time"], in s, and result[NAME], in the units of `description`; a picture of itself in Jupyter."""

    description: Any  # FMPy's ModelDescription; None where it is no whole motion

    @classmethod
    def of(cls, motion: Any) -> Result:
        result = motion.outputs.view(cls)
        result.description = motion.description
        return result

    def __array_finalize__(self, source: Any) -> None:
        self.description = getattr(source, "description", None)

    def __getitem__(self, key: Any) -> Any:
        found = super().__getitem__(key)
        return found.view(np.ndarray) if isinstance(key, str) else found

    def plot(self) -> Figure:
        """A figure of matplotlib with an axis for each unit; needs pip install lagrange-fmu[plot]."""
        from .problem import Problem
        from .simulation import figure_of

        try:
            return figure_of(self.description, self)
        except ModuleNotFoundError:
            raise Problem("matplotlib is not installed; it comes with pip install matplotlib") from None

    def to_pandas(self) -> Any:
        """A DataFrame with time, in s, as its index; needs pip install pandas."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.dtype.names}).set_index("time")

    def _repr_png_(self) -> bytes | None:
        from .problem import Problem

        if self.description is None or self.ndim != 1:
            return None
        try:
            figure = self.plot()
        except Problem:
            return None
        picture = io.BytesIO()
        figure.savefig(picture, format="png", dpi=100)
        return picture.getvalue()
