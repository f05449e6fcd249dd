"""
Motions with events in long doubles. events.c integrates up to a change. The state and modes after it follow here. Impacts obey Newton's law of
restitution through M, friction obeys Coulomb's law, and modes are the first combination that a short trial motion confirms.
"""

import ctypes
import itertools
from pathlib import Path

import numpy as np
import sympy as sp

from mechanics import velocity

from .reference import EVALUATIONS, INPUT_COEFFICIENTS, OUTCOMES, REAL, Undecided, compile_c, declarations, divided, guards_of, in_c
from .system import course

AHEAD = 1e-7  # duration of the trial motion, in s
OFF_KINK = 1e-16  # s
TOUCHING, SLOW, REST = 1e-12, 1e-12, 1e-13
EVENT_LIMIT, ROUND_LIMIT = 20000, 100
INTEGRATOR = Path(__file__).with_name("reference.c"), Path(__file__).with_name("events.c")


def real(values):
    return np.array(values, dtype=np.longdouble)


def pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(REAL))


def parts_in_c(derivation):
    """C source for one system, and the number of its parts."""
    mechanics, system = derivation.mechanics, derivation.system
    n, size, switches = len(mechanics.q), len(mechanics.terms), system.switches
    convert = lambda tree: sp.sympify(derivation.convert(tree))
    q, v, time = mechanics.q, mechanics.v, sp.Symbol("time")
    rest = lambda rate: sp.diff(rate, time) + sum(sp.diff(rate, qi) * vi for qi, vi in zip(q, v))
    flat = [*mechanics.mass, *(sp.sympify(sum(terms)) for terms in mechanics.terms)]
    contacts = switches.all_contacts
    for contact in contacts:
        gap = convert(contact.gap)
        rate = velocity(gap, q, v)
        flat += [gap, rate, rest(rate), *(sp.diff(gap, qi) for qi in q)]
    for friction in switches.frictions:
        slip = convert(friction.velocity)
        flat += [slip, rest(slip), convert(friction.force), convert(friction.stiction), *(sp.diff(slip, vi) for vi in v)]
    for event in switches.events:
        flat.append(convert(event.when) - (sp.Rational(1, 2) if event.direction is None else 0))
    sets = [convert(value) for event in switches.events for *_, value in event.sets]
    guards = guards_of(derivation)
    flat += [*sets, *(operand for operand, _ in guards)]
    names = [contact.name for contact in contacts]
    contacts_of_frictions = [-1 if f.contact is None else names.index(f.contact) for f in switches.frictions]
    constants = len(system.parameters) + INPUT_COEFFICIENTS * len(system.inputs) + 1
    sizes = dict(N=n, SIZE=size, CONTACTS=len(contacts), FRICTIONS=len(contacts_of_frictions), EVENTS=len(switches.events), SETS=len(sets),
                 GUARDS_HERE=len(guards), FIRST_MODE=constants, PARTS=len(flat) + len(guards))  # fmt: skip
    lines = [f"#define {label} {count}" for label, count in sizes.items()]
    lines += [f"#define HOLDERS {{{', '.join(map(str, contacts_of_frictions or [-1]))}}}"]
    lines += ["static void parts(real t, const real *y, const real *k, real *p) {", *declarations(derivation)]
    flags = constants + len(contacts) + len(contacts_of_frictions) + len(switches.events)
    lines += [f"real {mode} = k[{flags + i}];" for i, mode in enumerate(switches.modes)]
    statements, texts = in_c(flat)
    lines += statements
    lines += [f"p[{i}] = {text};" for i, text in enumerate(texts)]
    first = len(flat) - len(guards)
    lines += [f"{{ real g = p[{first + i}]; p[{len(flat) + i}] = {scale}; }}" for i, (_, scale) in enumerate(guards)]
    return lines + ["}"], sizes


class Modes:
    """Arrays closed, sliding, active and modes, in the order that follows the constants."""

    def __init__(self, sizes, system):
        counts = [sizes["CONTACTS"], sizes["FRICTIONS"], sizes["EVENTS"], len(system.switches.modes)]
        self.values = real(np.zeros(sum(counts)))
        ends = np.cumsum([0, *counts])
        self.closed, self.sliding, self.active, self.modes = (self.values[a:b] for a, b in zip(ends, ends[1:]))
        self.modes[:] = list(system.switches.modes.values())


class EventReference:
    """Reference for systems with events; its columns are the states, and those that System.columns adds."""

    def __init__(self, derivation, folder):
        from .reference import PRELUDE

        self.system = derivation.system
        lines, self.sizes = parts_in_c(derivation)
        source = Path(folder) / "parts.c"
        source.write_text("\n".join([PRELUDE, f'#include "{INTEGRATOR[0]}"', *lines, f'#include "{INTEGRATOR[1]}"', ""]))
        compile_c(source, source.with_suffix(".so"), "-O1")
        self.library = ctypes.CDLL(str(source.with_suffix(".so")))
        self.n, self.size = self.sizes["N"], self.sizes["SIZE"]
        self.contacts, self.frictions = self.system.switches.all_contacts, self.system.switches.frictions
        names = [contact.name for contact in self.contacts]
        self.contacts_of_frictions = [None if f.contact is None else names.index(f.contact) for f in self.frictions]

    # --- One trajectory ---

    def trajectory(self, columns, tolerance, fraction, kick=None):
        system, plan = self.system, self.system.plan
        self.options = columns, tolerance, fraction
        self.state, self.flags = real(system.start), Modes(self.sizes, system)
        self.step, self.evaluations, self.events = REAL(plan.length / 1000), ctypes.c_long(0), 0
        rows, parts = [], max(1, 12 // len(plan.actions))
        for communication in course(system):
            self.constants = self._constants(communication)
            self.time = np.longdouble(communication.time)
            if not rows:
                self._resolve_event(starts=True)
                rows.append(self._row())
            points = divided(communication.time, communication.end, parts)
            for moment, end in zip(points, points[1:]):
                self.time = np.longdouble(moment)
                if kick is not None:
                    self._kick(kick)
                self._advance(end)
            rows.append(self._row())
        return np.array(rows)

    def _constants(self, step):
        values = list(step.parameters.values())
        for coefficients in step.inputs.values():
            values += [*coefficients, *[0.0] * (INPUT_COEFFICIENTS - len(coefficients))]
        return real([*values, step.time])

    def _advance(self, end):
        while self.time < end:
            if self._follow(np.longdouble(end)):
                self.events += 1
                if self.events > EVENT_LIMIT:
                    raise Undecided("the reference meets too many events")
                self._resolve_event()

    def _follow(self, end):
        """Integrate to the end or the first change; return True if there is a change."""
        columns, tolerance, fraction = self.options
        all_constants = np.concatenate([self.constants, self.flags.values])
        time, last, reached, changed = real([self.time]), real([end]), real([0]), ctypes.c_int()
        outcome = self.library.advance(
            columns, ctypes.c_double(tolerance), ctypes.c_double(fraction), ctypes.c_double(self.system.plan.length / 40), pointer(time),
            pointer(last), pointer(self.state), pointer(all_constants), ctypes.byref(self.step), ctypes.byref(self.evaluations),
            ctypes.c_long(EVALUATIONS), pointer(reached), ctypes.byref(changed))  # fmt: skip
        if outcome != 0:
            raise Undecided(OUTCOMES[outcome])
        self.time = reached[0]
        return bool(changed.value)

    def _look(self, time=None, state=None, flags=None):
        s = self.sizes
        p = real(np.zeros(s["PARTS"] + self.size + s["CONTACTS"] + s["FRICTIONS"]))
        constants = np.concatenate([self.constants, (flags or self.flags).values])
        state = np.ascontiguousarray(self.state if state is None else state)
        self.library.look(REAL_of(self.time if time is None else time), pointer(state), pointer(constants), pointer(p))
        return Parts(self, p)

    def _row(self):
        p, f = self._look(), self.flags
        # The friction of an open contact has no direction.
        sliding = [np.nan if h is not None and f.closed[h] == 0 else s for h, s in zip(self.contacts_of_frictions, f.sliding)]
        return [float(x) for x in [*self.state, *f.modes, *p.forces, *f.closed, *sliding]]

    # --- Modes after a change ---

    def _resolve_event(self, starts=False):
        if starts:  # at a kink of a gap, the piece towards which the motion goes applies
            self.state[: self.n] += OFF_KINK * self.state[self.n :]
        for _ in range(ROUND_LIMIT):
            self._collide()
            self._choose()
            p = self._look()
            if starts:
                self.flags.active[:] = p.events > 0
                return
            if not self._happen(p):
                return
        raise Undecided("the reference finds events without end")

    def _happen(self, p):
        """Apply events whose expression has passed 0, with all values from before the first setting. Return True if there are any."""
        first, writes = 0, []
        for i, event in enumerate(self.system.switches.events):
            is_positive = p.events[i] > 0
            if is_positive != (self.flags.active[i] != 0):
                self.flags.active[i] = is_positive
                if event.direction in (None, "rising") and is_positive or event.direction == "falling" and not is_positive or event.direction == "both":
                    writes += [(kind, label, p.sets[first + k]) for k, (kind, label, _) in enumerate(event.sets)]
            first += len(event.sets)
        for kind, label, value in writes:
            if kind == "mode":
                self.flags.modes[list(self.system.switches.modes).index(label)] = value
            else:
                self.state[self.n + self.system.velocities.index(label)] = value
        return bool(writes)

    def _touches(self, p, i):
        return self.flags.closed[i] != 0 or p.gaps[i] <= TOUCHING

    def _collide(self):
        for _ in range(10000):
            p = self._look()
            rates = [p.rates[i] if self._touches(p, i) else 0 for i in range(len(self.contacts))]
            if not rates or min(rates) >= -REST:
                return
            self._hit(p, int(np.argmin(rates)))
        raise Undecided("the reference finds impacts without end")

    def _hit(self, p, i):
        """Apply Newton's law of restitution to one contact, and Coulomb's law to its friction, if the impact does not act across it."""
        along = p.response(p.gradients[i])
        push = -(1 + self.contacts[i].restitution) * p.rates[i] / (p.gradients[i] @ along)
        self.state[self.n :] += push * along
        for j, holder in enumerate(self.contacts_of_frictions):
            if holder != i:
                continue
            across = p.response(p.ways[j])
            if abs(p.ways[j] @ along) > 1e-15 * abs(push):
                raise Undecided("the reference knows no impact that turns friction")
            slip = p.slips[j]
            least = -slip / (p.ways[j] @ across)
            most = p.strengths[j] * push
            self.state[self.n :] += (least if abs(least) <= most else -np.sign(slip) * most) * across

    def _choose(self):
        """
        Choose the first combination of contacts and sticking frictions that a short trial motion confirms, in descending order of active
        constraints.
        """
        p, flags = self._look(), self.flags
        close = [i for i in range(len(self.contacts)) if self._touches(p, i) and abs(p.rates[i]) <= SLOW]
        flags.closed[:] = 0
        slow = []
        for j, slip in enumerate(p.slips):
            if abs(slip) <= SLOW:
                slow.append(j)
            else:
                flags.sliding[j] = np.sign(slip)
        signs = sorted(itertools.product((0, 1, -1), repeat=len(slow)), key=lambda s: sum(map(abs, s)))
        for count in range(len(close), -1, -1):
            for closed in itertools.combinations(close, count):
                for sign in signs:
                    flags.closed[:] = 0
                    flags.closed[list(closed)] = 1
                    flags.sliding[slow] = sign
                    if not self._is_idle_right(slow):
                        continue
                    state = self._constrained_state(p, closed, [j for j, s in zip(slow, sign) if s == 0])
                    if self._is_right(state, close, slow):
                        self.state = state
                        return
        raise Undecided("the reference finds no combination that is right")

    def _is_idle(self, j):
        return self.contacts_of_frictions[j] is not None and self.flags.closed[self.contacts_of_frictions[j]] == 0

    def _is_idle_right(self, slow):
        """True if each friction of an open contact has direction 1, which stands for all of its directions."""
        return all(self.flags.sliding[j] == 1 for j in slow if self._is_idle(j))

    def _constrained_state(self, p, closed, stuck):
        """The state without rounding errors in the velocities of active constraints."""
        state = self.state.copy()
        rows = [p.gradients[i] for i in closed] + [p.ways[j] for j in stuck]
        rates = [p.rates[i] for i in closed] + [p.slips[j] for j in stuck]
        if rows:
            state[self.n :] -= p.least_change(rows, rates)
        return state

    def _is_right(self, state, close, slow):
        if not close and not slow:
            return True
        kept = self.state, self.time, self.step, self.flags.active.copy()
        self.state, self.step = state.copy(), REAL(AHEAD)
        try:
            p = self._ahead()
        finally:
            self.state, self.time, self.step = kept[:3]
        if p is None:
            return False
        for i in close:
            if not (p.forces[i] > 0 if self.flags.closed[i] else p.rates[i] > 0):
                return False
        for j in slow:
            if self._is_idle(j):
                continue
            mode, bound = self.flags.sliding[j], p.stictions[j] * (1 if self.contacts_of_frictions[j] is None else p.forces[self.contacts_of_frictions[j]])
            if not (mode * p.slips[j] > 0 if mode else abs(p.forces[len(self.contacts) + j]) < bound):
                return False
        return True

    def _ahead(self):
        """State after a short time, ignoring further changes."""
        end, operands = self.time + AHEAD, real(np.zeros(2 * self.n))
        constants = np.concatenate([self.constants, self.flags.values])
        k = []
        for share in (0, 0.5, 0.5, 1):  # classical Runge-Kutta method
            state = self.state + (share * AHEAD * k[-1] if k else 0)
            p = self._look(self.time + share * AHEAD, state)
            if not np.all(np.isfinite(p.accelerations)):
                return None
            k.append(np.concatenate([state[self.n :], p.accelerations]))
        self.state = self.state + AHEAD / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
        return self._look(end)

    def _kick(self, kick):
        """Perturb the state along the active constraints."""
        change = real(kick([float(x) for x in self.state]))
        p = self._look()
        closed = [p.gradients[i] for i in np.flatnonzero(self.flags.closed)]
        stuck = [p.ways[j] for j in range(len(self.frictions)) if self.flags.sliding[j] == 0 and not self._is_idle(j)]
        if closed:
            change[: self.n] -= p.least_change(closed, [row @ change[: self.n] for row in closed])
        if closed + stuck:
            change[self.n :] -= p.least_change(closed + stuck, [row @ change[self.n :] for row in closed + stuck])
        self.state = self.state + change
        self._resolve_event()


def REAL_of(value):
    """A c_longdouble with all digits; its constructor would round to a double."""
    return REAL.from_buffer_copy(np.longdouble(value).tobytes())


def solve(matrix, right):
    """Gaussian elimination with pivoting in long doubles, which numpy.linalg does not support."""
    a, x = np.array(matrix, dtype=np.longdouble), np.array(right, dtype=np.longdouble)
    count = len(a)
    for k in range(count):
        pivot = k + int(np.argmax(abs(a[k:, k])))
        a[[k, pivot]], x[[k, pivot]] = a[[pivot, k]], x[[pivot, k]]
        if a[k, k] == 0:
            raise Undecided("the reference's forces are not determined")
        for i in range(k + 1, count):
            factor = a[i, k] / a[k, k]
            a[i, k:] -= factor * a[k, k:]
            x[i] -= factor * x[k]
    for k in range(count - 1, -1, -1):
        x[k] = (x[k] - a[k, k + 1 :] @ x[k + 1 :]) / a[k, k]
    return x


class Parts:
    """Results of look(), by name."""

    def __init__(self, reference, p):
        s, self.n, self.size = reference.sizes, reference.n, reference.size
        first = self.size * self.size
        self.mass = p[:first].reshape(self.size, self.size)
        contacts = p[first + self.size :][: s["CONTACTS"] * (3 + self.n)].reshape(s["CONTACTS"], 3 + self.n)
        first += self.size + contacts.size
        frictions = p[first:][: s["FRICTIONS"] * (4 + self.n)].reshape(s["FRICTIONS"], 4 + self.n)
        first += frictions.size
        self.gaps, self.rates, self.gradients = contacts[:, 0], contacts[:, 1], contacts[:, 3:]
        self.slips, self.strengths, self.stictions, self.ways = frictions[:, 0], frictions[:, 2], frictions[:, 3], frictions[:, 4:]
        self.events, self.sets = p[first:][: s["EVENTS"]], p[first + s["EVENTS"] :][: s["SETS"]]
        self.accelerations, self.forces = p[s["PARTS"] :][: self.n], p[s["PARTS"] + self.size :]

    def response(self, row):
        """Change of velocities by a unit impulse along a row, with constraints."""
        return solve(self.mass, np.concatenate([row, np.zeros(self.size - self.n)]))[: self.n]

    def least_change(self, rows, rates):
        answers = [self.response(row) for row in rows]
        factors = solve([[row @ answer for answer in answers] for row in rows], rates)
        return sum(push * answer for push, answer in zip(factors, answers))
