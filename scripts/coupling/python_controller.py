"""Define a state feedback for the cart as an FMU in Python, with PythonFMU."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class PythonController(Fmi2Slave):
    description = "F = -(kx x + ktheta theta + kv v + komega omega)"

    def __init__(self, **options):
        super().__init__(**options)
        self.x = self.theta = self.v = self.omega = self.F = 0.0
        self.kx, self.ktheta, self.kv, self.komega = -3.2, -40.0, -4.5, -8.5
        for name in ("x", "theta", "v", "omega"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("kx", "ktheta", "kv", "komega"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(Real("F", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.F = -(self.kx * self.x + self.ktheta * self.theta + self.kv * self.v + self.komega * self.omega)
        return True
