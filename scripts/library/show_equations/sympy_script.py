"""Write a listing as a script for SymPy, in which the equations can be changed, solved and evaluated."""

import ast
import keyword
import re

from .expression import WORD, Expression, is_cut
from .listing import Equation

FUNCTIONS = {"abs": "sp.Abs", "min": "sp.Min", "max": "sp.Max", "floor": "sp.floor", "sign": "sp.sign", "pow": "sp.Pow"}
UNKNOWN = {"uniform", "gauss"}  # functions that SymPy does not have
TAKEN = {"sp", "values", "time", "rate", "solve", "equations", "constraints", "coordinates", "velocities", "accelerations", "multipliers", "states", "rates", "power", "kinetic_energy", "potential_energy", "conditions", "lagrangian", *keyword.kwlist}
VALUES = {"K": "kinetic_energy", "T": "lagrangian_kinetic_energy", "U": "potential_energy", "P": "power"}
TAKEN |= set(VALUES.values())

TOOLS = '''
def rate(expression):
    """Return the time derivative along the motion."""
    known = [(time, 1), *zip(coordinates, velocities), *zip(velocities, accelerations), *zip(states, rates), *input_rates]
    return sum((sp.diff(expression, symbol) * value for symbol, value in known), sp.Integer(0))


# What the equations of motion lack: the constraints, differentiated until accelerations appear. An open contact and a sliding friction have no force.
conditions = [rate(expression) if expression.has(*velocities) else rate(rate(expression)) for _, expression, _ in constraints]
conditions = [holds * condition + (1 - holds) * force for condition, (force, _, holds) in zip(conditions, constraints)]


def solve(values):
    """Return the accelerations and multipliers by their symbols, where the symbols have these values; of least norm where constraints are redundant."""
    unknowns = [*accelerations, *multipliers]
    if not unknowns:
        return {}
    rows = [(left - right).subs(values) for left, right in equations] + [condition.subs(values) for condition in conditions]
    matrix, right = sp.linear_eq_to_matrix(rows, unknowns)
    regular = matrix.rank(iszerofunc=lambda x: abs(x) < 1e-10) == len(unknowns)
    return dict(zip(unknowns, matrix.LUsolve(right) if regular else matrix.pinv() * right))


if __name__ == "__main__":
    for left, right in equations:
        sp.pprint(sp.Eq(left, right, evaluate=False))
    for symbol, value in solve(values).items():
        print(symbol, "=", value)
'''


class Names:
    """Unique Python names for the names of the system."""

    def __init__(self):
        self.of = {"time": "time"}
        self.taken = set(TAKEN)

    def add(self, name):
        if name not in self.of:
            word = re.sub(r"\W+", "_", name).strip("_")
            while word in self.taken:
                word += "_"
            self.taken.add(word)
            self.of[name] = word
        return self.of[name]


class Translator(ast.NodeTransformer):
    """Replace the names and functions of the language by those of Python."""

    def __init__(self, expression, names):
        self.expression = expression
        self.names = names

    def visit_Name(self, node):
        return ast.Name(self.names.of[self.expression.name(node)])

    def visit_BinOp(self, node):
        self.generic_visit(node)
        whole = [isinstance(part, ast.Constant) and isinstance(part.value, int) for part in (node.left, node.right)]
        return ast.Call(ast.Name("sp.Rational"), [node.left, node.right], []) if isinstance(node.op, ast.Div) and all(whole) else node

    def visit_Call(self, node):
        function, arguments = self.expression.name(node.func), [self.visit(argument) for argument in node.args]
        if function == "if":
            condition, value, other = arguments
            arguments = [ast.Tuple([value, condition]), ast.Tuple([other, ast.Constant(True)])]
            called = "sp.Piecewise"
        else:
            called = f'sp.Function("{function}")' if function in UNKNOWN else FUNCTIONS.get(function, f"sp.{function}")
        return ast.Call(ast.Name(called), arguments, [])


def names_in(text):
    """Yield the variables of an expression."""
    for found in WORD.finditer(text):
        if not text[found.end() :].startswith("("):
            yield found[0]


def in_order(definitions):
    """Return definitions, texts by name, as a list of pairs, each after those that it uses."""
    ordered, done = [], set()

    def visit(left):
        if left not in done:
            done.add(left)
            for name in filter(definitions.__contains__, names_in(definitions[left])):
                visit(name)
            ordered.append((left, definitions[left]))

    for left in definitions:
        visit(left)
    return ordered


class Script:
    """The script of a listing, built part by part in `lines`."""

    def __init__(self, listing):
        self.listing = listing
        self.names = Names()
        self.lines = []
        self.declared = []
        self.motion = self.entries("Equations of motion")
        self.constraints = self.entries("Constraints")
        self.rates = self.entries("States")
        self.energies = self.entries("Energies", "Power of the non-conservative forces")
        self.outputs = self.entries("Outputs")
        self.definitions = {entry.left: entry.right for entry in self.entries("Calculated parameters", "Definitions")}
        self.velocities = [variable.name for variable in listing.variables["velocity"]]

    def entries(self, *headings):
        return [entry for heading in headings for entry in self.listing.sections.get(heading, []) if isinstance(entry, Equation)]

    def python(self, text):
        expression = Expression(text)
        return ast.unparse(Translator(expression, self.names).visit(expression.tree))

    def declare(self, name, comment=""):
        if name not in self.definitions and name not in self.names.of:
            self.lines.append(f'{self.names.add(name)} = sp.Symbol("{name}")' + (f"  # {comment}" if comment else ""))
            self.declared.append(name)

    def head(self):
        title = ": ".join(filter(None, [self.listing.name, self.listing.description])).replace("\\", "/").replace('"', "'")
        self.lines += [f'"""\n{title}\n\nThe equations of motion by lagrange-fmu {self.listing.version}, for SymPy.\n"""', "", "import sympy as sp", "", 'time = sp.Symbol("time")']

    def symbols(self):
        for kind, variables in self.listing.variables.items():
            if variables:
                self.lines += ["", "# Velocities" if kind == "velocity" else f"# {kind.capitalize()}s"]
            for variable in variables:
                self.declare(variable.name, ": ".join(filter(None, [variable.unit, variable.description])))
        self.lines += ["", "# Accelerations, multipliers, and what else the equations contain"]
        for name in [*(f"der({velocity})" for velocity in self.velocities), *self.listing.multipliers, *(mode for _, mode in self.listing.switches.values())]:
            self.declare(name)
        texts = [text for entry in [*self.motion, *self.constraints] for text in (entry.left, entry.right)]
        texts += [entry.right for entry in [*self.rates, *self.energies, *self.outputs]] + [*self.definitions.values()]
        for text in texts:
            for name in names_in(text) if not is_cut(text) else ():
                self.declare(name)

    def values(self):
        starts = {variable.name: variable.start for variables in self.listing.variables.values() for variable in variables}
        unknown = {*self.listing.multipliers, *(f"der({velocity})" for velocity in self.velocities)}
        known = [name for name in self.declared if name not in unknown]
        self.lines += ["", "# Start values", "values = {", "    time: 0.0,", *(f"    {self.names.of[name]}: {starts.get(name, 0.0)!r}," for name in known), "}"]

    def assignments(self):
        self.lines += ["", "# Definitions, energies, power and outputs"]
        pairs = [(self.names.add(left), right) for left, right in in_order(self.definitions)]
        pairs += [(VALUES[entry.left], entry.right) for entry in self.energies]
        pairs += [(self.names.add(f"output {entry.left}"), entry.right) for entry in self.outputs]
        for name, right in pairs:
            self.lines.append(f'{name} = sp.Symbol("{name}")  # too long to be shown' if is_cut(right) else f"{name} = {self.python(right)}")

    def lists(self):
        of, variables = self.names.of, self.listing.variables
        moved = [name for name in self.declared if f"der({name})" in of and name not in self.velocities]
        rows = {
            "coordinates": [of[variable.name] for variable in variables["coordinate"]],
            "velocities": [of[name] for name in self.velocities],
            "accelerations": [of[f"der({name})"] for name in self.velocities],
            "multipliers": [of[name] for name in self.listing.multipliers],
            "states": [of[entry.left[4:-1]] for entry in self.rates],
            "rates": [self.python(entry.right) for entry in self.rates],
            "input_rates": ["({}, {})".format(of[name], of[f"der({name})"]) for name in moved],
        }
        self.lines += ["", *(f"{name} = [{', '.join(row)}]" for name, row in rows.items())]

    def equations(self):
        self.lines += ["", "# Pairs of the left and the right side, by coordinates", "equations = ["]
        for entry in self.motion:
            cut = is_cut(entry.left) or is_cut(entry.right)
            self.lines.append(f"    # {entry.label}: too long to be shown" if cut else f"    ({self.python(entry.left)}, {self.python(entry.right)}),  # {entry.label}")
        self.lines.append("]")

    def conditions(self):
        forces = {constraint: force for force, constraint in self.listing.multipliers.items()}
        self.lines += ["", "# The force of each constraint, what is 0, and what is 1 while this holds, else 0", "constraints = ["]
        for entry in self.constraints:
            name = re.split("[:,]", entry.label)[0]
            kind, mode = self.listing.switches.get(name, ("", ""))
            holds = {"": "1", "contact": self.names.of.get(mode), "friction": f"1 - {self.names.of.get(mode)}**2"}[kind]
            cut = is_cut(entry.left)
            self.lines.append(f"    # {name}: too long to be shown" if cut else f"    ({self.names.of[forces[name]]}, sp.sympify({self.python(entry.left)}), {holds}),")
        self.lines += ["]", ""]

    def text(self):
        for part in (self.head, self.symbols, self.values, self.assignments, self.lists, self.equations, self.conditions):
            part()
        return "\n".join(self.lines) + "\n" + TOOLS.strip("\n")


def script_of(listing):
    return Script(listing).text()
