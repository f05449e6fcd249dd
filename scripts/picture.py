"""A figure that Jupyter shows."""

import io

from matplotlib.figure import Figure


class Picture(Figure):
    """A figure of matplotlib; Jupyter shows it as it is, since pyplot does not know it."""

    def _repr_png_(self):
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=100)
        return picture.getvalue()
