"""
Define the functions and types of FMI-LS-WASM, a draft of a layered standard of FMI 3.0 for WebAssembly components.

Names, types and their order are those of the package fmi:fmi3@3.0.0. Types have the syntax of WIT: list<f64>, option<f64>, tuple<f64, u32>,
result<VALUE, status>.
"""

PACKAGE = "fmi:fmi3/{}@3.0.0"

# Types of the interface `types`, by name.
TYPES = {
    "value-reference": "u32",
    "status": {"enum": ["ok", "warning", "discard", "error", "fatal"]},
    "fmu-state": "list<u8>",
    "interval-qualifier": {"enum": ["interval-not-yet-known", "interval-unchanged", "interval-changed"]},
    "interval-fraction": {"record": {"counter": "u64", "resolution": "u64"}},
    "dependency-kind": {"enum": ["dependent", "constant", "fixed", "tunable", "discrete"]},
    "variable-dependency": {"record": {"dependent-value-reference": "value-reference", "element-index-of-dependent": "u32",
                                       "independent-value-reference": "value-reference", "element-index-of-independent": "u32",
                                       "kind": "dependency-kind"}},
    "discrete-states-info": {"record": {"new-discrete-states-needed": "bool", "terminate-simulation": "bool",
                                        "nominals-of-continuous-states-changed": "bool", "values-of-continuous-states-changed": "bool",
                                        "next-event-time-defined": "bool", "next-event-time": "f64"}},
}  # fmt: skip

LOG_MESSAGE = {"instance-name": "string", "status": "status", "category": "string", "message": "string"}

_REFERENCES = {"value-references": "list<value-reference>"}
_JACOBIAN = {"unknowns": "list<value-reference>", "knowns": "list<value-reference>", "seed": "list<f64>"}
_REQUESTS = {"requests": "list<tuple<value-reference, u32>>"}
_NAMES = {"instance-name": "string", "instantiation-token": "string", "visible": "bool", "logging-on": "bool"}
_NO_SET_BEFORE = {"no-set-fmu-state-prior-to-current-point": "bool"}

# Types of variables, by the suffix of their get and set functions.
_VALUES = {"float32": "f32", "float64": "f64", "int8": "s8", "int16": "s16", "int32": "s32", "int64": "s64", "uint8": "u8", "uint16": "u16",
           "uint32": "u32", "uint64": "u64", "boolean": "bool", "string": "string", "binary": "list<u8>", "clock": "bool"}  # fmt: skip

# Methods of both kinds of instances: parameters without the instance, and the result type.
_COMMON = {
    "set-debug-logging": ({"logging-on": "bool", "categories": "list<string>"}, "status"),
    "enter-initialization-mode": ({"tolerance": "option<f64>", "start-time": "f64", "stop-time": "option<f64>"}, "status"),
    **{name: ({}, "status") for name in ("exit-initialization-mode", "enter-event-mode", "enter-step-mode", "enter-configuration-mode",
                                         "exit-configuration-mode", "evaluate-discrete-states", "terminate", "reset")},
    "update-discrete-states": ({}, "result<discrete-states-info, status>"),
    **{f"get-{name}": (_REFERENCES, f"result<list<{value}>, status>") for name, value in _VALUES.items()},
    **{f"set-{name}": ({**_REFERENCES, "values": f"list<{value}>"}, "status") for name, value in _VALUES.items()},
    "get-number-of-variable-dependencies": ({"vr": "value-reference"}, "result<u64, status>"),
    "get-variable-dependencies": ({"dependent": "value-reference"}, "result<list<variable-dependency>, status>"),
    "get-fmu-state": ({}, "result<fmu-state, status>"),
    "set-fmu-state": ({"state": "fmu-state"}, "status"),
    "get-directional-derivative": (_JACOBIAN, "result<list<f64>, status>"),
    "get-adjoint-derivative": (_JACOBIAN, "result<list<f64>, status>"),
    "get-output-derivatives": (_REQUESTS, "result<list<f64>, status>"),
    "get-interval-decimal": (_REFERENCES, "result<list<tuple<f64, interval-qualifier>>, status>"),
    "get-interval-fraction": (_REFERENCES, "result<list<tuple<interval-fraction, interval-qualifier>>, status>"),
    "get-shift-decimal": (_REFERENCES, "result<list<f64>, status>"),
    "get-shift-fraction": (_REFERENCES, "result<list<interval-fraction>, status>"),
    "set-interval-decimal": ({**_REFERENCES, "intervals": "list<f64>"}, "status"),
    "set-interval-fraction": ({**_REFERENCES, "intervals": "list<interval-fraction>"}, "status"),
    "set-shift-decimal": ({**_REFERENCES, "shifts": "list<f64>"}, "status"),
    "set-shift-fraction": ({**_REFERENCES, "shifts": "list<interval-fraction>"}, "status"),
}  # fmt: skip

# Kinds of instances: their own types, the parameters of instantiate, and the methods.
KINDS = {
    "co-simulation": {
        "types": {"do-step-result": {"record": {"last-successful-time": "f64", "event-handling-needed": "bool", "terminate-simulation": "bool",
                                                "early-return": "bool"}}},
        "instantiate": {**_NAMES, "event-mode-used": "bool", "early-return-allowed": "bool",
                        "required-intermediate-variables": "list<value-reference>"},
        "methods": {
            **_COMMON,
            "set-input-derivatives": ({**_REQUESTS, "values": "list<f64>"}, "status"),
            "do-step": ({"current-communication-point": "f64", "communication-step-size": "f64", **_NO_SET_BEFORE},
                        "result<do-step-result, status>"),
        },
    },
    "model-exchange": {
        "types": {"completed-step-result": {"record": {"enter-event-mode": "bool", "terminate-simulation": "bool"}}},
        "instantiate": _NAMES,
        "methods": {
            **_COMMON,
            "enter-continuous-time-mode": ({}, "status"),
            "set-time": ({"time": "f64"}, "status"),
            "set-continuous-states": ({"continuous-states": "list<f64>"}, "status"),
            **{f"get-{name}": ({}, "result<list<f64>, status>") for name in ("continuous-state-derivatives", "event-indicators", "continuous-states",
                                                                             "nominals-of-continuous-states")},
            **{f"get-number-of-{name}": ({}, "result<u64, status>") for name in ("event-indicators", "continuous-states")},
            "completed-integrator-step": (_NO_SET_BEFORE, "result<completed-step-result, status>"),
        },
    },
}  # fmt: skip
