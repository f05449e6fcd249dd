"""
Accelerations of robots from their URDF with mpmath. Links are placed by the definition of the format. Energies follow from difference quotients of
high precision, and accelerations from Lagrange's equation. Joints with quaternions are not covered.
"""

import functools
import xml.etree.ElementTree as ET

import mpmath as mp

COORDINATES = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "fixed": 0}


def numbers(element, name, default):
    return [mp.mpf(text) for text in (element.get(name, default) if element is not None else default).split()]


def turn(axis, angle):
    """Rotation matrix by Rodrigues' formula, 1 + sin [e] + (1 - cos) [e]^2."""
    x, y, z = axis
    cross = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + mp.sin(angle) * cross + (1 - mp.cos(angle)) * cross * cross


@functools.cache
def place(element):
    """Translation and rotation of an <origin>, to the precision of the first call."""
    origin = element.find("origin")
    roll, pitch, yaw = numbers(origin, "rpy", "0 0 0")
    rotation = turn((0, 0, 1), yaw) * turn((0, 1, 0), pitch) * turn((1, 0, 0), roll)
    return mp.matrix(numbers(origin, "xyz", "0 0 0")), rotation


def across(axis):
    """The x and y axes of a planar joint: x is the coordinate axis after the one nearest to the joint's axis, projected onto the plane."""
    sizes = [abs(component) for component in axis]
    next_one = (sizes.index(max(sizes)) + 1) % 3
    first = [(j == next_one) - axis[next_one] * axis[j] for j in range(3)]
    first = [component / mp.norm(mp.matrix(first)) for component in first]
    second = [axis[(j + 1) % 3] * first[(j + 2) % 3] - axis[(j + 2) % 3] * first[(j + 1) % 3] for j in range(3)]
    return mp.matrix(first), mp.matrix(second)


class Robot:
    def __init__(self, text):
        root = ET.fromstring(text)
        self.joints = root.findall("joint")
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.index, self.count = {}, 0  # index of the first coordinate by joint name
        for joint in self.joints:
            if joint.find("mimic") is None:
                self.index[joint.get("name")] = self.count
                self.count += COORDINATES[joint.get("type")]

    def position(self, joint, q):
        mimic = joint.find("mimic")
        if mimic is None:
            return q[self.index[joint.get("name")]]
        other = next(j for j in self.joints if j.get("name") == mimic.get("joint"))
        return mp.mpf(mimic.get("multiplier", "1")) * self.position(other, q) + mp.mpf(mimic.get("offset", "0"))

    def motion(self, joint, q):
        kind, axis = joint.get("type"), mp.matrix(numbers(joint.find("axis"), "xyz", "1 0 0"))
        axis /= mp.norm(axis)
        if kind == "fixed":
            return mp.zeros(3, 1), mp.eye(3)
        if kind == "prismatic":
            return axis * self.position(joint, q), mp.eye(3)
        if kind == "planar":
            first, second = across(axis)
            x, y, angle = q[self.index[joint.get("name")] :][:3]
            return first * x + second * y, turn(axis, angle)
        return mp.zeros(3, 1), turn(axis, self.position(joint, q))

    def poses(self, q):
        """Position and rotation matrix of each link's frame."""
        carried = {joint.find("child").get("link"): joint for joint in self.joints}
        poses = {}

        def pose(name):
            if name not in carried:
                return mp.zeros(3, 1), mp.eye(3)
            if name not in poses:
                joint = carried[name]
                position, rotation = pose(joint.find("parent").get("link"))
                for shift, rotated in (place(joint), self.motion(joint, q)):
                    position, rotation = position + rotation * shift, rotation * rotated
                poses[name] = position, rotation
            return poses[name]

        return {name: pose(name) for name in self.links}

    def masses(self, q):
        """Mass, inertia tensor, centre of mass and axes of the tensor of each link that has an <inertial>."""
        for name, (position, rotation) in self.poses(q).items():
            inertial = self.links[name].find("inertial")
            if inertial is None:
                continue
            shift, rotated = place(inertial)
            get = lambda key: mp.mpf(inertial.find("inertia").get(key))
            tensor = mp.matrix([[get("i" + "".join(sorted(a + b))) for b in "xyz"] for a in "xyz"])
            yield mp.mpf(inertial.find("mass").get("value")), tensor, position + rotation * shift, rotation * rotated

    def potential_energy(self, q):
        return sum(mass * mp.mpf("9.81") * position[2] for mass, _, position, _ in self.masses(q))

    def mass_matrix(self, q, h=mp.mpf(10) ** -20):
        """
        Mass matrix from the velocities of each body, and its angular velocities along the axes of the tensor, per unit rate of each
        coordinate.
        """
        rates = []
        for i in range(self.count):
            before, after = ([*self.masses([x + s * h * (i == j) for j, x in enumerate(q)])] for s in (-1, 1))
            rates.append([((p1 - p0) / (2 * h), (r1 - r0) / (2 * h)) for (_, _, p0, r0), (_, _, p1, r1) in zip(before, after)])
        matrix = mp.zeros(self.count)
        for body, (mass, tensor, _, axes) in enumerate(self.masses(q)):
            velocities, spins = [], []
            for rate in rates:
                velocity, spin = rate[body][0], axes.T * rate[body][1]
                velocities.append(velocity)
                spins.append(mp.matrix([spin[2, 1], spin[0, 2], spin[1, 0]]))
            for i in range(self.count):
                for j in range(self.count):
                    matrix[i, j] += mass * (velocities[i].T * velocities[j])[0] + (spins[i].T * tensor * spins[j])[0]
        return matrix

    def accelerations(self, q, v, forces, h=mp.mpf(10) ** -10):
        """Solve M a = Q + dL/dq - d(M v)/dq v."""
        q, v = [mp.mpf(x) for x in q], mp.matrix([mp.mpf(x) for x in v])
        slope = lambda function, way: (function(1, way) - function(-1, way)) / (2 * h)
        at = lambda s, way: [x + s * h * w for x, w in zip(q, way)]
        lagrangian = lambda s, way: (v.T * self.mass_matrix(at(s, way)) * v)[0] / 2 - self.potential_energy(at(s, way))
        right = mp.matrix(forces) - slope(lambda s, way: self.mass_matrix(at(s, way)) * v, v)
        for i in range(self.count):
            right[i] += slope(lagrangian, [mp.mpf(i == j) for j in range(self.count)])
        return [float(a) for a in mp.lu_solve(self.mass_matrix(q), right)]
