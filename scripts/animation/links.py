"""
What holds what, found in the motion itself: places that stay together are a joint, particles that keep their distance have a
rod between them. So a pendulum gets its rod, whether a formula or a constraint holds it.
"""

import itertools
import re
from dataclasses import dataclass

import numpy as np

SAMPLES = 60
ALL_PAIRS = 150  # of more elements than that, each is compared with its neighbours alone


@dataclass
class End:
    element: int | None  # None: the base
    place: np.ndarray  # from the element's position, along its own axes, m


@dataclass
class Link:
    start: End
    end: End
    kind: str  # "rod" where the distance is kept, else "line"


def _samples(array):
    return array[np.linspace(0, len(array) - 1, min(SAMPLES, len(array))).astype(int)]


def _pairs(places):
    """Of places among the elements, with the base as None."""
    if len(places) <= ALL_PAIRS:
        return itertools.combinations([None, *places], 2)
    return [*((None, place) for place in places), *itertools.pairwise(places)]


def _size(elements):
    positions = np.concatenate([_samples(element.position) for element in elements])
    return float(np.linalg.norm(np.ptp(positions, axis=0))) or 1.0


def _rotations(angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([cosine, -sine], axis=1), np.stack([sine, cosine], axis=1)], axis=1)


def _joint(elements, first, second, size):
    """
    The place u of the first, and w of the second, that stay together, where there is one such pair: least squares of
    r1 + R1 u = r2 + R2 w over the motion. A particle has no other place than its own.
    """
    columns, right = [], 0.0
    for place, sign in ((first, 1.0), (second, -1.0)):
        if place is None:
            columns.append(np.tile(sign * np.eye(2), (len(_samples(elements[second].position)), 1, 1)))
            continue
        element = elements[place]
        right = right - sign * _samples(element.position)[:, :2]
        if element.angle is not None:
            columns.append(sign * _rotations(_samples(element.angle)))
    matrix = np.concatenate(columns, axis=2).reshape(right.size, -1)
    found, _, _, singular = np.linalg.lstsq(matrix, right.ravel(), rcond=None)
    apart = np.max(np.abs(matrix @ found - right.ravel()))
    # Without turning against one another, any place would do.
    if singular[-1] < 0.01 * singular[0] or apart > 1e-5 * size:
        return None
    ends, k = [], 0
    for place in (first, second):
        turns = place is None or elements[place].angle is not None
        ends.append(End(place, np.array([*found[k : k + 2], 0.0]) if turns else np.zeros(3)))
        k += 2 if turns else 0
    return ends


def joints(elements):
    """Of bodies in the plane with one another, with particles, and with the base: pairs of ends."""
    flat = [i for i, element in enumerate(elements) if element.angle is not None or (element.kind == "particle" and element.frame is None)]
    size = _size(elements) if elements else 1.0
    found = []
    for pair in _pairs(flat):
        if any(place is not None and elements[place].angle is not None for place in pair):
            ends = _joint(elements, *pair, size)
            if ends is not None:
                found.append(ends)
    return found


class _Groups:
    """Which elements are connected already."""

    def __init__(self):
        self.of = {}

    def find(self, element):
        while self.of.get(element, element) != element:
            element = self.of[element]
        return element

    def join(self, first, second):
        """Whether they were apart."""
        first, second = self.find(first), self.find(second)
        self.of[first] = second
        return first != second


def _distances(elements, first, second):
    start = 0.0 if first is None else _samples(elements[first].position)
    return np.linalg.norm(_samples(elements[second].position) - start, axis=1)


def _is_kept(distances):
    return np.ptp(distances) <= 1e-3 * distances.max()


def _rods(elements, places):
    """The shortest that hold all together which keep their distances, and those that they hold."""
    rigid = []
    for first, second in _pairs(places):
        distances = _distances(elements, first, second)
        if _is_kept(distances):
            rigid.append((distances.max(), first, second))
    groups, links, held = _Groups(), [], set()
    for length, first, second in sorted(rigid, key=lambda rod: rod[0]):
        if groups.join(first, second) and length > 0.0:
            links.append(Link(End(first, np.zeros(3)), End(second, np.zeros(3)), "rod"))
            held |= {first, second}
    return links, held


def _series(elements, places):
    """Neighbours by their names: bob[1] and bob[2], or body1 and body2."""
    by_name = {elements[place].name: place for place in places}
    for name, place in by_name.items():
        number = re.fullmatch(r"(.*\[|.*body)(\d+)(\]?)", name)
        before = number and by_name.get(f"{number[1]}{int(number[2]) - 1}{number[3]}")
        if before is not None:
            yield before, place


def _between_particles(elements):
    places = [i for i, element in enumerate(elements) if element.kind in ("particle", "point") and element.frame is None]
    links, held = _rods(elements, places)
    loose = [pair for pair in _series(elements, places) if not held.issuperset(pair)]
    if len(elements) == 1 and len(places) == 1 and not held:
        loose.append((None, places[0]))
    return links + [Link(End(first, np.zeros(3)), End(second, np.zeros(3)), "line") for first, second in loose]


def links_of(elements, found):
    """From frames to what is in them, from bodies to their joints, and between particles."""
    links = _between_particles(elements)
    for ends in found:
        for end in ends:
            if end.element is not None and end.place.any():
                links.append(Link(End(end.element, np.zeros(3)), end, "rod"))
    for i, element in enumerate(elements):
        kept = _is_kept(_distances(elements, element.frame, i))
        # What moves freely in the base has no line to it.
        if element.frame is not None or (element.kind == "frame" and kept):
            links.append(Link(End(element.frame, np.zeros(3)), End(i, np.zeros(3)), "rod" if kept else "line"))
    return links
