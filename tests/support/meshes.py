"""Meshes that tests write: points, polygons of point numbers, and files."""

import struct

import numpy as np
from scipy.spatial import ConvexHull

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SQUARES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(8)  # regular, with edges of length 1


def triangles_of(points):
    """Triangles of the convex hull, counterclockwise as seen from outside."""
    hull = ConvexHull(points)
    triangles = []
    for (a, b, c), plane in zip(hull.simplices, hull.equations):
        outwards = np.cross(points[b] - points[a], points[c] - points[a]) @ plane[:3] > 0
        triangles.append([a, b, c] if outwards else [a, c, b])
    return triangles


def stl_text(points, triangles):
    facets = []
    for triangle in triangles:
        corners = "".join("      vertex {:.17g} {:.17g} {:.17g}\n".format(*points[i]) for i in triangle)
        facets.append(f"  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n")
    return f"solid mesh\n{''.join(facets)}endsolid mesh\n"


def stl_bytes(points, triangles):
    records = (struct.pack("<12fH", 0, 0, 0, *np.asarray(points)[triangle].ravel(), 0) for triangle in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(records)


def msh_bytes(points, triangles):
    """A file of MuJoCo's format MSH, with normals and texture coordinates that mean nothing."""
    counts = np.array([len(points), 1, 2, len(triangles)], "<i4")
    return counts.tobytes() + np.asarray(points, "<f4").tobytes() + bytes(12) + bytes(16) + np.array(triangles, "<i4").tobytes()


def obj_text(points, polygons, first=1):
    """Text of an OBJ file. `first` is the number of the first point: 1, or negative for relative numbers."""
    corners = "".join("v {:.17g} {:.17g} {:.17g}\n".format(*point) for point in points)
    return corners + "".join("f " + " ".join(str(first + i) for i in polygon) + "\n" for polygon in polygons)
