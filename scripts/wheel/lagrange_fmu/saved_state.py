"""The state of an instance of FMI 2.0 or 3.0 as bytes."""

from contextlib import contextmanager
from ctypes import byref, c_size_t
from dataclasses import dataclass

from fmpy.fmi3 import fmi3Byte, fmi3FMUState

from .problem import Problem


@dataclass(frozen=True)
class State:
    """A saved state at a time in s; it can be pickled, and restored in every simulation of the same FMU."""

    time: float
    fmu: str  # its GUID
    content: bytes

    def __repr__(self):
        return f"<state at {self.time:.9g} s, {len(self.content)} bytes>"


def check_state(state, description):
    """Raise Problem unless it is a State of this FMU."""
    if not isinstance(state, State):
        raise Problem(f"{state!r} is not a saved state; expected the result of save()")
    if state.fmu != description.guid:
        raise Problem(f"the state is of another FMU than {description.modelName}; expected one of the same build")


def check_ability(description):
    if not (description.coSimulation.canGetAndSetFMUstate and description.coSimulation.canSerializeFMUstate):
        raise Problem(f"{description.modelName} cannot save its state; expected an FMU with canGetAndSetFMUstate and canSerializeFMUstate")


@contextmanager
def _freed(fmu, state):
    try:
        yield state
    finally:
        fmu.freeFMUState(state)


def content2(fmu):
    with _freed(fmu, fmu.getFMUState()) as state:
        return fmu.serializeFMUstate(state)


def go_to2(fmu, content):
    with _freed(fmu, fmu.deSerializeFMUstate(content)) as state:
        fmu.setFMUState(state)


def content3(fmu):
    with _freed(fmu, fmu.getFMUState()) as state:
        size = c_size_t()
        fmu.fmi3SerializedFMUStateSize(fmu.component, state, byref(size))
        content = (fmi3Byte * size.value)()
        fmu.fmi3SerializeFMUState(fmu.component, state, content, size.value)
        return bytes(content)


def go_to3(fmu, content):
    with _freed(fmu, fmi3FMUState()) as state:
        fmu.fmi3DeserializeFMUState(fmu.component, (fmi3Byte * len(content)).from_buffer_copy(content), len(content), byref(state))
        fmu.setFMUState(state)
