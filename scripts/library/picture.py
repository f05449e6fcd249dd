"""Show figures in Jupyter without pyplot."""

import io

from matplotlib.figure import Figure


class Picture(Figure):
    """A figure of matplotlib that is not registered with pyplot, so that Jupyter shows it exactly once."""

    def _repr_png_(self):
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=100)
        return picture.getvalue()
