"""Write the initial inputs of the fuzzer of meshes: meshes.py FOLDER. A cube in each format, after the byte that selects the format."""

import struct
import sys
from itertools import product
from pathlib import Path

CORNERS = list(product((-0.5, 0.5), repeat=3))
SQUARES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = [[CORNERS[a], CORNERS[b], CORNERS[c]] for w, x, y, z in SQUARES for a, b, c in ((w, x, y), (w, y, z))]


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    points = "".join("v {} {} {}\n".format(*corner) for corner in CORNERS)
    polygons = "".join("f " + " ".join(f"{i + 1}/1/1" for i in square) + " \\\n -1\n" for square in SQUARES)
    facets = ["facet normal 0 0 1\nouter loop\n" + "".join("vertex {} {} {}\n".format(*p) for p in t) + "endloop\nendfacet\n" for t in TRIANGLES]
    records = [struct.pack("<12fH", 0, 0, 0, *sum(triangle, ()), 0) for triangle in TRIANGLES]
    (folder / "cube.obj").write_text("1" + points + polygons)
    (folder / "text.stl").write_text("0solid cube\n" + "".join(facets) + "endsolid cube\n")
    (folder / "binary.stl").write_bytes(b"0" + bytes(80) + struct.pack("<I", len(records)) + b"".join(records))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
