"""Write a LagrangesMethod of sympy.physics.mechanics as a system in XML."""

import inspect
import re
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import sympy
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics import LagrangesMethod, ReferenceFrame, Vector, dynamicsymbols

from .problem import Problem
from .sympy_expressions import Names, normalized, text_of
from .variables import nearest
from .whole_files import write_whole


def _generalized_forces(method):
    """Return the generalized forces Q_i = sum of F . d(v)/d(q_i'), where v is the velocity at the point of a force, or its frame's angular velocity."""
    frame, forces = method.inertial, [sympy.S.Zero] * len(method.q)
    for location, vector in method.forcelist or []:
        if frame is None:
            raise Problem("the LagrangesMethod has forces and no inertial frame; expected frame=N")
        velocity = location.ang_vel_in(frame) if isinstance(location, ReferenceFrame) else location.vel(frame)
        for i, speed in enumerate(method.q.diff(dynamicsymbols._t)):
            forces[i] += velocity.diff(speed, frame, var_in_dcm=False).dot(vector)
    return forces


class _Content:
    """The expressions of a LagrangesMethod, with plain symbols of valid names in place of its quantities."""

    def __init__(self, method, speeds, watched, states):
        self.time = dynamicsymbols._t
        self.coordinates = list(method.q)
        self.velocities = [q.diff(self.time) for q in self.coordinates]
        speeds = None if speeds is None else [dynamicsymbols(speed) if isinstance(speed, str) else speed for speed in ([speeds] if isinstance(speeds, str) else speeds)]
        if speeds is not None and len(speeds) != len(self.velocities):
            raise Problem(f"there are {len(speeds)} speeds and {len(self.velocities)} coordinates; expected one for each")
        for speed in speeds or []:
            if not isinstance(speed, AppliedUndef):
                raise Problem(f"{speed} is not a speed; expected a dynamicsymbol or a name")
        self.velocity_of = dict(zip(speeds or [], self.velocities))
        rates = self._rates(states)
        in_motion = self._substituted([*method._L, *method._hol_coneqs, *method.coneqs[len(method._hol_coneqs) :]])
        forces = self._substituted(_generalized_forces(method))
        watched = {name: self._substituted(expressions) for name, expressions in watched.items()}
        others = sum(watched.values(), forces)

        self.inputs = self._derivatives_of_inputs(in_motion, others, rates)
        symbols = set().union(*(expression.free_symbols for expression in in_motion + others + rates))
        self.parameters = sorted(symbols - {self.time}, key=str)
        self.names = self._named(speeds)
        symbol_of = {quantity: sympy.Symbol(name) for quantity, name in self.names.items()}
        self.lagrangian, *self.constraints = [expression.xreplace(symbol_of) for expression in in_motion]
        self.forces = [expression.xreplace(symbol_of) for expression in forces]
        self.states = {state: rate.xreplace(symbol_of) for state, rate in zip(self.rate_of, rates)}
        self.watched = {name: [expression.xreplace(symbol_of) for expression in expressions] for name, expressions in watched.items()}

    def _substituted(self, expressions):
        """Return expressions with velocities in place of speeds, and with rates in place of the derivatives of states."""
        derivatives = {state.diff(self.time): rate for state, rate in self.rate_of.items()}
        found = [normalized(expression).xreplace(self.velocity_of) for expression in expressions]
        for _ in derivatives:
            found = [expression.xreplace(derivatives) for expression in found]
        return found

    def _rates(self, states):
        """Keep the rate of each state of first order as it is given, and return it normalized."""
        self.rate_of = {}
        for state, rate in states.items():
            state = dynamicsymbols(state) if isinstance(state, str) else state
            if not isinstance(state, AppliedUndef) or state in (*self.coordinates, *self.velocity_of):
                raise Problem(f"{state} is not a state; expected a dynamicsymbol or a name that is neither a coordinate nor a speed")
            self.rate_of[state] = normalized(rate).xreplace(self.velocity_of)
        rates = self._substituted(self.rate_of.values())
        for state, rate in zip(self.rate_of, rates):
            if any(derivative.expr in self.rate_of for derivative in rate.atoms(sympy.Derivative)):
                raise Problem(f"the rate of {state} needs itself, or a second derivative of a state; expected rates by states, coordinates, velocities and inputs")
        return rates

    def _derivatives_of_inputs(self, in_motion, others, rates):
        """Return the order of the highest derivative that is needed of each input; inputs are functions of time that are not coordinates."""
        counts = {}
        for expression in in_motion + others + rates:
            for function in expression.atoms(AppliedUndef):
                if function.args != (self.time,):
                    raise Problem(f"the function {function} is not known; expected coordinates and inputs, which are functions of t alone")
                if function not in self.coordinates and function not in self.rate_of:
                    # A prescribed motion needs the velocity and the acceleration of its input.
                    counts[function] = max(counts.get(function, 0), 2 if expression in in_motion else 0)
            for derivative in expression.atoms(sympy.Derivative):
                function, count = derivative.expr, derivative.derivative_count
                if function in self.coordinates and count > 1 and not (expression in rates and count == 2):
                    raise Problem(f"{derivative} is an acceleration; expected energies, forces and constraints without any")
                if count > 2:
                    raise Problem(f"{derivative}: expected at most the second derivative of an input")
                if function in counts:
                    counts[function] = max(counts[function], count)
        return dict(sorted(counts.items(), key=str))

    def _named(self, speeds):
        """Return the name of each quantity, and of the inputs' derivatives, such as der(F)."""
        self.all_names = Names()
        functions = [*self.coordinates, *self.rate_of, *self.inputs]
        names = {quantity: self.all_names.add(quantity.func.__name__) for quantity in functions}
        names |= {parameter: self.all_names.add(parameter) for parameter in self.parameters}
        for q, v, speed in zip(self.coordinates, self.velocities, speeds or self.coordinates):
            names[v] = self.all_names.add(speed.func.__name__ if speeds else f"{names[q]}_dot")
            names[v.diff(self.time)] = f"der({names[v]})"
        for function, count in self.inputs.items():
            for i in range(1, count + 1):
                names[function.diff(self.time, i)] = "der(" * i + names[function] + ")" * i
        return names | {self.time: "time"}

    def energies(self):
        """Return the kinetic energy, the sum of all terms with velocities, and the potential energy, minus the sum of the others."""
        velocities = {sympy.Symbol(self.names[v]) for v in self.velocities}
        terms = sympy.Add.make_args(self.lagrangian)
        kinetic = [term for term in terms if term.free_symbols & velocities]
        return sympy.Add(*kinetic), -sympy.Add(*(term for term in terms if term not in kinetic))


def _by_quantity(given, quantities, kind):
    """
    Return the dict with quantities as keys; raise Problem for an unknown key.

    Keys are compared as text, since symbols of one name may differ in their assumptions. Functions of time match without "(t)", too.
    """
    if not isinstance(given, Mapping):
        raise Problem(f"the values of each {kind} are a {type(given).__name__}; expected a dict of values by symbol or name")
    known = {str(quantity): quantity for quantity in quantities}
    names = {quantity.func.__name__: quantity for quantity in quantities if isinstance(quantity, AppliedUndef)} | known
    for key in given:
        if str(key) not in names:
            near = nearest(str(key).removesuffix("(t)"), names)
            raise Problem(f"{key} is not a {kind} of this LagrangesMethod; {f'did you mean {near}?' if near else 'expected ' + ', '.join(known)}")
    return {names[str(key)]: value for key, value in given.items()}


def _values(given, quantities, kind):
    """Return the numbers as text, by quantity; raise Problem if one is not a number."""
    values = {}
    for key, value in _by_quantity(given, quantities, kind).items():
        try:
            values[key] = repr(float(value))
        except (TypeError, ValueError):
            raise Problem(f"{key}: {value} is not a number; expected one") from None
    return values


def _units(content, units, outputs):
    """Return the attributes with units of parameters, inputs and coordinates by quantity, and of outputs by name."""
    units = {key: {"unit": str(unit)} for key, unit in units.items()}
    of_outputs = {key: unit for key, unit in units.items() if key in outputs}
    of_quantities = {key: unit for key, unit in units.items() if key not in outputs}
    known = [*content.parameters, *content.inputs, *content.coordinates, *content.states]
    return _by_quantity(of_quantities, known, "parameter, input, coordinate, state or output"), of_outputs


def _variables(content, parameters, start, units):
    """Yield the elements of parameters, inputs and coordinates, as (tag, attributes, text)."""
    values = _values(parameters, content.parameters, "parameter")
    missing = [str(symbol) for symbol in content.parameters if symbol not in values]
    if missing:
        raise Problem(f"no value is given for {', '.join(missing)}; expected parameters={{{missing[0]}: 1.0, ...}}")
    speed_of = {str(speed): velocity for speed, velocity in content.velocity_of.items()} | {content.names[velocity]: velocity for velocity in content.velocities}
    start = {speed_of.get(str(key), key): value for key, value in start.items()} if isinstance(start, Mapping) else start
    start = _values(start, [*content.coordinates, *content.velocities, *content.states, *content.inputs], "coordinate, velocity, state or input")
    for symbol in content.parameters:
        yield "parameter", {"name": content.names[symbol], "start": values[symbol]} | units.get(symbol, {}), None
    for function, count in content.inputs.items():
        names = {"name": content.names[function], "start": start.get(function, "0")}
        yield "input", names | ({"derivatives": str(count)} if count else {}) | units.get(function, {}), None
    for q, v in zip(content.coordinates, content.velocities):
        names = {"name": content.names[q], "velocity": content.names[v]}
        yield "coordinate", names | {"start": start.get(q, "0"), "velocityStart": start.get(v, "0")} | units.get(q, {}), None
    for state, rate in content.states.items():
        names = {"name": content.names[state], "rate": text_of(rate, f"the rate of {state}"), "start": start.get(state, "0")}
        yield "state", names | units.get(state, {}), None


def _equations(content, constraint_names):
    """Yield the elements of energies, forces and constraints."""
    kinetic, potential = content.energies()
    yield "kinetic", {}, text_of(kinetic, "the kinetic energy")
    if potential != 0:
        yield "potential", {}, text_of(potential, "the potential energy")
    for q, force in zip(content.coordinates, content.forces):
        if force != 0:
            yield "force", {"coordinate": content.names[q]}, text_of(force, f"the force along {q}")
    if constraint_names is None:
        constraint_names = [f"constraint{i}" for i, _ in enumerate(content.constraints, 1)]
    if len(constraint_names) != len(content.constraints):
        raise Problem(f"there are {len(constraint_names)} names and {len(content.constraints)} constraints; expected one for each, holonomic ones first")
    for name, constraint in zip(constraint_names, content.constraints):
        yield "constraint", {"name": content.all_names.add(name)}, text_of(constraint, f"the constraint {constraint}")


def _watched(content, points, units):
    """Yield the elements of points, which are drawn, and of outputs."""
    for name, expressions in content.watched.items():
        if name in points:
            places = [text_of(expression, f"the point {name}") for expression in expressions]
            yield "point", {"name": content.all_names.add(name)} | dict(zip("xyz", places)), None
        else:
            [expression] = expressions
            yield "output", {"name": content.all_names.add(name)} | units.get(name, {}), text_of(expression, f"the output {name}")


def _positions(points, frame):
    """Return the two or three coordinates of each point; vectors are expressed in the frame."""
    places = {}
    for name, place in points.items():
        if isinstance(place, Vector):
            if frame is None:
                raise Problem(f"the point {name} is a vector, and the LagrangesMethod has no inertial frame; expected frame=N, or a tuple of coordinates")
            place = place.to_matrix(frame)
        places[name] = list(place)
        if len(places[name]) not in (2, 3):
            raise Problem(f"the point {name} has {len(places[name])} coordinates; expected two or three")
    return places


def _system_name(path):
    name = path.stem if path.name != "system.xml" else path.resolve().parent.name
    if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,99}", name):
        raise Problem(f"'{name}' cannot name a system; expected a file of letters, digits and _, such as Pendulum.xml")
    return name


def from_sympy(
    method, path, parameters, start=None, speeds=None, description="", stop_time=10.0, outputs=None, units=None, constraints=None, points=None, states=None
):
    """
    Write a LagrangesMethod as NAME.xml.

    All dynamicsymbols that are neither coordinates, speeds nor states become inputs. Symbols may be given by their names in all dicts.

    Parameters
    ----------
    method : LagrangesMethod
        Lagrangian, forces, holonomic and nonholonomic constraints.
    path : path
        The file to write, NAME.xml; NAME is the name of the system.
    parameters : dict of float
        Values of all other symbols of the method.
    start : dict of float, optional
        Start values of coordinates, velocities, states and inputs; 0 by default.
    speeds : sequence, optional
        A dynamicsymbol or name for the derivative of each coordinate; by default the velocity of x is x_dot.
    description : str
        Description of the system.
    stop_time : float
        End of the experiment, in s.
    outputs : dict, optional
        Expressions by name, which become outputs.
    units : dict of str, optional
        Units of parameters, inputs, coordinates, states and outputs, such as "kg".
    constraints : sequence of str, optional
        Names of the constraints, holonomic ones first.
    points : dict, optional
        Points that the animation shows, by name: vectors from the origin, such as P.pos_from(O), or tuples of two or three coordinates.
    states : dict, optional
        States of first order, such as a pressure or the integral of a controller. The values are time derivatives of each dynamicsymbol or name, as
        functions of all other quantities and accelerations.

    Returns
    -------
    Path
        The path of the file.

    Raises
    ------
    Problem
        If a value is missing, a key is unknown, or an expression has no counterpart in the language.

    Examples
    --------
    >>> from_sympy(method, "Pendulum.xml", {m: 1, l: 0.5, g: 9.81}, start={theta: 1}, outputs={"height": l*cos(theta)})
    """
    path = Path(path)
    if not isinstance(method, LagrangesMethod):
        raise Problem(
            f"a {type(method).__name__} has no energies to write; expected a LagrangesMethod(L, q, forcelist=..., bodies=..., frame=N)"
            " of the same bodies and loads, with L = Lagrangian(N, *bodies)"
        )
    points, outputs = _positions(points or {}, method.inertial), outputs or {}
    both = sorted(set(points) & set(outputs))
    if both:
        raise Problem(f"{both[0]} is a point and an output; expected two names")
    content = _Content(method, speeds, points | {name: [expression] for name, expression in outputs.items()}, states or {})
    units_of_quantities, units_of_outputs = _units(content, units or {}, outputs)
    root = ElementTree.Element("system", name=_system_name(path), description=description)
    for tag, attributes, text in [
        *_variables(content, parameters, start or {}, units_of_quantities),
        *_watched(content, points, units_of_outputs),
        *_equations(content, constraints),
    ]:
        ElementTree.SubElement(root, tag, attributes).text = text
    ElementTree.SubElement(root, "experiment", stopTime=repr(float(stop_time)))
    ElementTree.indent(root)
    return write_whole(path, ElementTree.tostring(root, encoding="unicode") + "\n")


OPTIONS = tuple(inspect.signature(from_sympy).parameters)[3:]
