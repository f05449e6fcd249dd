"""An animation of a simulated FMU as one HTML page, which needs no network."""

import html
import json
import re
from pathlib import Path

import numpy as np

from .links import joints, links_of
from .scene import AXES, elements_of, upwards

HERE = Path(__file__).resolve().parent
MAX_FRAMES, MAX_NUMBERS = 1500, 200_000  # which keeps a page below 2 MB
SHORTEST, LONGEST = 2.0, 60.0  # s of motion that are shown as they are; others take
SHOWN = 10.0  # s
MAX_TRAILS = 6


def quaternions(rotation):
    """Of matrices, each with the sign that is nearer to the one before."""
    m = rotation
    trace = np.trace(m, axis1=1, axis2=2)
    # Four times the products of each component with all; the row with the largest square is divided by its root.
    products = np.empty((len(m), 4, 4))
    products[:, 0, 0] = 1.0 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        products[:, i + 1, i + 1] = 1.0 - trace + 2.0 * m[:, i, i]
        products[:, 0, i + 1] = products[:, i + 1, 0] = m[:, k, j] - m[:, j, k]
        products[:, j + 1, k + 1] = products[:, k + 1, j + 1] = m[:, k, j] + m[:, j, k]
    largest = np.argmax(np.einsum("nii->ni", products), axis=1)
    rows = products[np.arange(len(m)), largest]
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    flips = np.where(np.sum(rows[1:] * rows[:-1], axis=1) < 0.0, -1.0, 1.0)
    rows[1:] *= np.cumprod(flips)[:, None]
    return rows


def box_of(element, direction):
    """
    The sides of a uniform box of the same mass and moments of inertia, and the matrix of its axes in the body's. Of a body
    in the plane only Izz is known: it is a rod along the direction in which its joints are, else a square plate.
    """
    if not element.mass > 0.0 or not np.isfinite(element.inertia).all():
        return np.zeros(3), np.eye(3)
    if element.angle is not None:
        square = 12.0 * element.inertia[2, 2] / element.mass  # the sum of the squares of its sides
        if direction is None:
            return np.sqrt([square / 2, square / 2, 0.0]), np.eye(3)
        cosine, sine = direction
        return np.sqrt([square, 0.0, 0.0]), np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    moments, axes = np.linalg.eigh(element.inertia)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    squares = 6.0 * (moments.sum() - 2.0 * moments) / element.mass
    return np.sqrt(np.maximum(squares, 0.0)), axes


def _directions(elements, found):
    """Of each body in the plane: towards its joint farthest from the centre of mass, a unit vector; None where there is none."""
    farthest = {}
    for ends in found:
        for end in ends:
            if end.element is not None and np.linalg.norm(end.place) > np.linalg.norm(farthest.get(end.element, np.zeros(3))):
                farthest[end.element] = end.place
    return {i: place[:2] / np.linalg.norm(place) for i, place in farthest.items()}


def _view(elements, sizes, found, up):
    """Which plane is seen, to the right and upwards, where all moves in one; what is where, m."""
    fixed = [end.place for ends in found for end in ends if end.element is None]
    points = np.concatenate([*(element.position for element in elements), *(place[None] for place in fixed)])
    low, high = points.min(axis=0), points.max(axis=0)
    if np.all(low - 2.0 * (high - low).max() < 0.0) and np.all(high + 2.0 * (high - low).max() > 0.0):
        low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)  # the origin, unless it is far away
    radius = max(0.5 * float(np.linalg.norm(high - low)), *(0.5 * float(np.linalg.norm(size)) for size in sizes)) or 1.0
    moves = [bool(np.ptp(points[:, axis]) > 1e-9 * radius or abs(points[0, axis]) > 1e-9 * radius) for axis in range(3)]
    rotations = [element.rotation for element in elements if element.rotation is not None]
    across = [axis for axis in (2, 1, 0) if not moves[axis] and all(np.allclose(turn[:, axis], np.eye(3)[axis], atol=1e-9) for turn in rotations)]
    plane = [name for name in AXES if name != AXES[across[0]]] if across else None
    return {"plane": plane, "up": up.tolist(), "low": low.tolist(), "high": high.tolist(), "radius": radius}


class _Writer:
    """Tracks: a number where nothing changes, else one a frame, in digits that the picture can show."""

    def __init__(self, rows, length):
        self.rows, self.digits = rows, max(0, 5 - int(np.floor(np.log10(length))))

    def track(self, column, digits):
        column = np.round(column[self.rows], digits) + 0.0
        return float(column[0]) if np.all(column == column[0]) else column.tolist()

    def lengths(self, columns):
        return [self.track(column, self.digits) for column in columns.T]


def _shown_rows(elements, count):
    tracks = sum(3 + (element.angle is not None) + 4 * (element.rotation is not None) for element in elements)
    frames = max(2, min(MAX_FRAMES, count, MAX_NUMBERS // tracks))
    return np.unique(np.linspace(0, count - 1, frames).round().astype(int))


def _trails(elements, found):
    """Of particles, points and bodies without joints: a few, or that of the last one."""
    jointed = {end.element for ends in found for end in ends}
    free = [i for i, e in enumerate(elements) if e.kind in ("particle", "point") or (e.angle is not None and i not in jointed)]
    moving = [i for i in free if np.ptp(elements[i].position, axis=0).any()]
    return set(moving if len(moving) <= MAX_TRAILS else moving[-1:])


def scene_data(description, elements, times, up=np.array([0.0, 0.0, 1.0])):
    """What the page draws, as in geometry.js."""
    found = joints(elements)
    directions = _directions(elements, found)
    boxes = [box_of(element, directions.get(i)) for i, element in enumerate(elements)]
    view = _view(elements, [sides for sides, _ in boxes], found, up)
    rows = _shown_rows(elements, len(times))
    writer, trails = _Writer(rows, view["radius"]), _trails(elements, found)
    heaviest = max((e.mass for e in elements if np.isfinite(e.mass)), default=0.0) or 1.0
    largest = 0.07 * view["radius"] / (1.0 + len(elements) / 8)
    data = []
    for i, (element, (sides, axes)) in enumerate(zip(elements, boxes)):
        one = {"kind": element.kind, "name": element.name, "position": writer.lengths(element.position)}
        if element.angle is not None:
            one["angle"] = writer.track(element.angle, 5)
        if element.rotation is not None:
            one["turn"] = [writer.track(column, 5) for column in quaternions(element.rotation).T]
        if element.frame is not None:
            one["frame"] = element.frame
        if element.kind == "body" and sides.any():
            one["sides"] = np.maximum(sides, sides.max() / 25).round(writer.digits + 1).tolist()
            one["axes"] = quaternions(axes[None])[0].round(5).tolist()
        else:
            share = np.cbrt(element.mass / heaviest) if np.isfinite(element.mass) else 0.5
            one["radius"] = round(largest * (0.3 + 0.7 * share), writer.digits + 1) if element.mass else 0.0
        if i in trails:
            one["trail"] = True
        data.append(one)
    place = lambda end: [-1 if end.element is None else end.element, end.place.round(writer.digits).tolist()]  # noqa: E731
    links = links_of(elements, found)
    marks = [ends[0] for ends in found] + [link.start for link in links if link.start.element is None]
    duration = times[-1] - times[0]
    return {
        "name": description.modelName,
        "times": np.round(times[rows], 9).tolist(),
        "speed": 1.0 if SHORTEST <= duration <= LONGEST else float(f"{duration / SHOWN:.1g}"),
        "view": view,
        "elements": data,
        "links": [{"from": place(link.start), "to": place(link.end), "kind": link.kind} for link in links],
        "marks": [place(end) for end in marks],
    }


def page(description, data):
    parts = {
        "TITLE": html.escape(description.description or description.modelName),
        "SCENE": json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
        "SCRIPT": (HERE / "geometry.js").read_text() + (HERE / "player.js").read_text(),
    }
    return re.sub("@(TITLE|SCENE|SCRIPT)@", lambda part: parts[part[1]], (HERE / "page.html").read_text())


def write_animation(path, description, scene, result, values):
    """The page of a simulation's result, a structured array."""
    elements = elements_of(scene, result, values)
    path.write_text(page(description, scene_data(description, elements, np.array(result["time"]), upwards(scene, values))))
