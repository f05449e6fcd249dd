"""Build a WebAssembly component around an FMU's module: functions of adapter.c with the types of interface.py, and resources for instances."""

import re
from pathlib import Path

from .interface import KINDS, LOG_MESSAGE, PACKAGE, TYPES

ADAPTER = Path(__file__).resolve().parent / "adapter.c"
MEMORY_PAGES = 128  # initial memory of the module, in pages of 64 kB
LINK_WORDS = ["-mexec-model=reactor", "-s", "-Wl,--gc-sections", "-Wl,--import-memory", "-Wl,-z,stack-size=1048576",
              f"-Wl,--initial-memory={MEMORY_PAGES * 65536}"]  # fmt: skip

# A module that has only the memory: functions of the host that read the memory must exist before the module that calls them.
MEMORY = f'(core module $memory (memory (export "memory") {MEMORY_PAGES}))'

# A module that makes an instance: it wraps the instance's address into the handle of a resource, or returns none if the address is 0.
MAKER = """
(core module $make-{kind}
  (import "module" "instantiate" (func $instantiate (param {parameters}) (result i32)))
  (import "module" "memory" (memory 0))
  (import "module" "place" (func $place (result i32)))
  (import "resource" "new" (func $new (param i32) (result i32)))
  (func (export "instantiate") (param {parameters}) (result i32) (local $component i32)
    {arguments}
    (local.set $component (call $instantiate))
    (i32.store (call $place) (i32.ne (local.get $component) (i32.const 0)))
    (if (local.get $component) (then (i32.store offset=4 (call $place) (call $new (local.get $component)))))
    (call $place)))
"""

# A module that initializes the C library of the FMU's module.
BEGINNER = """
(core module $begin (import "module" "_initialize" (func $initialize)) (start $initialize))
(core instance (instantiate $begin (with "module" (instance $module))))
"""


def split(text):
    """Split a text such as "a, b<c, d>" at its outer commas."""
    parts, depth = [""], 0
    for character in text:
        depth += (character == "<") - (character == ">")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts]


def typed(text, prefix=""):
    """Return a type in the text format; names of types begin with $ and the prefix."""
    if isinstance(text, dict) and "enum" in text:
        return f"(enum {' '.join(map(quoted, text['enum']))})"
    if isinstance(text, dict):
        return "(record " + " ".join(f"(field {quoted(name)} {typed(kind, prefix)})" for name, kind in text["record"].items()) + ")"
    generic = re.fullmatch(r"(\w+)<(.*)>", text)
    if generic:
        parts = [typed(part, prefix) for part in split(generic[2])]
        if generic[1] == "result":
            return f"(result {parts[0]} (error {parts[1]}))"
        return f"({generic[1]} {' '.join(parts)})"
    return text if re.fullmatch(r"bool|string|[fsu]\d+", text) else f"${prefix}{text}"


def quoted(name):
    return f'"{name}"'


def parameters_of(parameters, prefix=""):
    return " ".join(f"(param {quoted(name)} {typed(kind, prefix)})" for name, kind in parameters.items())


def functions_of(kind):
    """Yield each function of a kind of instance: its name in the interface, the name in adapter.c, the parameters, and the result type."""
    resource, content = f"{kind}-instance", KINDS[kind]
    yield f"[static]{resource}.instantiate-{kind}", f"instantiate-{kind}", content["instantiate"], f"option<own<{resource}>>"
    for name, (parameters, result) in content["methods"].items():
        yield f"[method]{resource}.{name}", name, {"self": f"borrow<{resource}>", **parameters}, result


def signature(parameters, result, prefix=""):
    return f"{parameters_of(parameters, prefix)} (result {typed(result, prefix)})"


def types_of(kind):
    """Return the types of a kind's interface by name, those of the interface `types` first."""
    return TYPES | KINDS[kind]["types"]


def flat(parameters):
    """Return the core types of a module's function for these parameters; options are not supported."""
    flat_types = {"string": "i32 i32", "bool": "i32"}
    return " ".join(flat_types.get(kind, "i32 i32") for kind in parameters.values())


def maker(kind):
    numbers = flat(KINDS[kind]["instantiate"])
    arguments = " ".join(f"(local.get {i})" for i in range(len(numbers.split())))
    return MAKER.format(kind=kind, parameters=numbers, arguments=arguments)


def naming_component(kind):
    """
    Return the lines of a component that names types and functions.

    Exported functions may only refer to exported types. This component imports functions with plain types, and exports them with the
    exported types of the interface.
    """
    resource = f"{kind}-instance"
    lines = [f"(component $naming-{kind}"]
    for name, content in types_of(kind).items():
        lines.append(f"(type $plain-{name} {typed(content, 'in-')}) (import {quoted('type-' + name)} (type $in-{name} (eq $plain-{name})))")
    lines.append(f"(import {quoted('type-' + resource)} (type $in-{resource} (sub resource)))")
    for i, (_, _, parameters, result) in enumerate(functions_of(kind)):
        lines.append(f"(import {quoted(f'function{i}')} (func $function-{i} {signature(parameters, result, 'in-')}))")
    for name in [*types_of(kind), resource]:
        lines.append(f"(export $out-{name} {quoted(name)} (type $in-{name}))")
    for i, (name, _, parameters, result) in enumerate(functions_of(kind)):
        lines.append(f"(export {quoted(name)} (func $function-{i}) (func {signature(parameters, result, 'out-')}))")
    return lines + [")"]


def kind_of_instance(kind):
    """Return the lines of a kind of instance: the resource, its functions, and the instance of the interface."""
    resource = f"{kind}-instance"
    lines = [f"(type ${name} {typed(content)})" for name, content in KINDS[kind]["types"].items()]
    lines.append(f'(type ${resource} (resource (rep i32) (dtor (func $module "free-instance"))))')
    lines.append(f"(core func $new-{kind} (canon resource.new ${resource}))")
    lines.append(maker(kind))
    lines.append(f"""(core instance $maker-{kind} (instantiate $make-{kind}
      (with "module" (instance (export "instantiate" (func $module "instantiate-{kind}")) (export "place" (func $module "place"))
                               (export "memory" (memory $memory "memory"))))
      (with "resource" (instance (export "new" (func $new-{kind}))))))""")
    for i, (name, does, parameters, result) in enumerate(functions_of(kind)):
        function = f'$maker-{kind} "instantiate"' if name.startswith("[static]") else f"$module {quoted(does)}"
        forget = '(post-return (func $module "forget-list"))' if re.search("list|fmu-state", result) else ""
        lines.append(f"""(func ${kind}{i} {signature(parameters, result)} (canon lift (core func {function}) (memory $memory "memory")
          (realloc (func $module "cabi_realloc")) {forget}))""")
    lines += naming_component(kind)
    lines.append(f"(instance $named-{kind} (instantiate $naming-{kind}")
    lines += [f"(with {quoted('type-' + name)} (type ${name}))" for name in [*types_of(kind), resource]]
    lines += [f"(with {quoted(f'function{i}')} (func ${kind}{i}))" for i, _ in enumerate(functions_of(kind))]
    lines.append("))")
    lines.append(f"(export {quoted(PACKAGE.format(kind))} (instance $named-{kind}))")
    return lines


def imports():
    """Return the lines of the imports from the host: the types, and the function that receives log messages."""
    lines = [f"(import {quoted(PACKAGE.format('types'))} (instance $types"]
    for name, content in TYPES.items():
        lines.append(f"(type $plain-{name} {typed(content, 'offered-')}) (export {quoted(name)} (type $offered-{name} (eq $plain-{name})))")
    lines.append("))")
    lines += [f"(alias export $types {quoted(name)} (type ${name}))" for name in TYPES]
    lines.append(f"""(import {quoted(PACKAGE.format("callbacks"))} (instance $callbacks (export "status" (type $log-status (eq $status)))
      (export "log-message" (func {parameters_of(LOG_MESSAGE, "log-")}))))""")
    return lines


def component_text():
    """Return the text of the component, with an empty module, the first one, in place of the FMU's module."""
    lines = ["(component", "(core module $fmu)", *imports(), MEMORY, "(core instance $memory (instantiate $memory))"]
    lines.append('(core func $log-message (canon lower (func $callbacks "log-message") (memory $memory "memory")))')
    lines.append("""(core instance $module (instantiate $fmu (with "env" (instance $memory))
      (with "callbacks" (instance (export "log-message" (func $log-message))))))""")
    lines.append(BEGINNER)
    lines.append("""(func $get-version (result string) (canon lift (core func $module "get-version") (memory $memory "memory")
      (realloc (func $module "cabi_realloc"))))""")
    lines.append(f"""(instance $common (export "get-version" (func $get-version))) (export {quoted(PACKAGE.format("common"))} (instance $common))""")
    for kind in KINDS:
        lines += kind_of_instance(kind)
    return "\n".join([*lines, ")"])


# Identifiers of sections in a component.
NAMES, MODULE, COMPONENT = 0, 1, 4


def number_in(data, place):
    """Decode an unsigned LEB128 number; return it, and the offset after it."""
    value, shift = 0, 0
    while data[place] >= 0x80:
        value, shift, place = value | (data[place] & 0x7F) << shift, shift + 7, place + 1
    return value | data[place] << shift, place + 1


def number_as_bytes(value):
    """Encode an unsigned number as LEB128."""
    low, rest = value & 0x7F, value >> 7
    return bytes([low]) if rest == 0 else bytes([low | 0x80]) + number_as_bytes(rest)


def sections_of(component):
    place = 8
    while place < len(component):
        kind = component[place]
        size, place = number_in(component, place + 1)
        yield kind, component[place : place + size]
        place += size


def rewritten(content, is_module, module=None):
    """Return a component or module without its name sections; `module`, if given, replaces the first module of a component."""
    parts = [content[:8]]
    for kind, section in sections_of(content):
        if kind == MODULE and not is_module and module is not None:
            section, module = module, None
        elif kind in (MODULE, COMPONENT) and not is_module:
            section = rewritten(section, kind == MODULE)
        if kind != NAMES:
            parts += [bytes([kind]), number_as_bytes(len(section)), section]
    return b"".join(parts)


def component_of(module):
    """Return the bytes of the component around an FMU's module."""
    from wasmtime import wat2wasm

    return rewritten(bytes(wat2wasm(component_text())), False, module)
