"""Invalid system.xml files: each gives the expected line and message, and no output."""

import re
import resource
import signal
import subprocess

import pytest

from bad_inputs import check_error, check_warning, inputs
from fmu import LAGC, ROOT, lagc

# A valid system; some tests replace one of its lines, counted from 1.
RIGHT = """\
<system name="Broken" description="Pendulum">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="1" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="tau" unit="N.m"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="1"/>
  <particle name="bob" mass="m" x="l*sin(theta)" y="-l*cos(theta)"/>
  <potential>m*g*bob.y</potential>
  <force coordinate="theta">tau</force>
  <output name="height" unit="m">bob.y</output>
  <solver method="erk" tolerance="1e-8"/>
  <experiment stopTime="10" stepSize="0.01"/>
</system>
"""

def broken(line, text):
    lines = RIGHT.splitlines()
    lines[line - 1] = text
    return "\n".join(lines)


def compile_text(text, folder, *words):
    (folder / "system.xml").write_text(text)
    return lagc("system.xml", "-o", "out", *words, cwd=folder)


def test_the_valid_system_compiles(tmp_path):
    result = compile_text(RIGHT, tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@inputs("language/bad")
def test_broken_system(file, tmp_path):
    check_error(file, "system.xml", tmp_path)


@inputs("language/suspicious")
def test_warnings(file, tmp_path):
    check_warning(file, "system.xml", tmp_path)


@inputs("language/valid")
def test_no_warning(file, tmp_path):
    result = compile_text(file.read_text(), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("text, message", [
    (b"", "1: the file does not begin with an element; expected <system"),
    (b"\n \n", "3: the file does not begin with an element"),
    (bytes(range(256)), "1: the file does not begin with an element"),
    (RIGHT.replace("Pendulum", "P\u00e9ndulum").encode("latin-1"), "1: .*an encoding other than UTF-8; save it in UTF-8"),
    (RIGHT.replace("system", "System").encode(), "1: the file begins with <System>; expected <system name="),
    ((RIGHT + RIGHT).encode(), "14: the file has text after the end of its first element"),
])  # fmt: skip
def test_files_without_a_system(text, message, tmp_path):
    (tmp_path / "system.xml").write_bytes(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert re.fullmatch(f"system.xml:({message}).*\n", result.stderr), result.stderr


@pytest.mark.parametrize("element", ["event", "sample"])
def test_events_without_coordinates_and_states(element, tmp_path):
    trigger = {"event": 'event when="time > 1"', "sample": 'sample every="1"'}[element]
    text = f"""<system name="Q">\n<mode name="n"/><{trigger}><set mode="n">n + 1</set></{element}>\n<output name="y">n</output></system>"""
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.fullmatch(f"system.xml:2: an? <{element}> needs coordinates or states.*; expected a <state>, such as .*\n", result.stderr), result.stderr


@pytest.mark.parametrize("version", ["1.1", "1.2", "0.0"])
def test_another_version_of_xml(version, tmp_path):
    """lagc reads the file with a warning, as XML 1.0 requires for 1.x."""
    result = compile_text(f'<?xml version="{version}"?>\n{RIGHT}', tmp_path)
    assert (result.returncode, result.stderr) == (0, "system.xml:1: warning: the first line names a version of XML other than 1.0; expected <?xml version=\"1.0\"?>, or no such line\n")


@pytest.mark.parametrize("first", ["\n", "<!-- a\n", "<!-- <?xml\n--> <!-- b -->"])
def test_a_declaration_after_comments(first, tmp_path):
    """Messages about lines below it stay right."""
    end = "-->" if first.endswith("a\n") else ""
    text = f'{first}{end}<?xml version="1.0" encoding="UTF-8"\n?>\n{RIGHT}'
    result = compile_text(text, tmp_path)
    warning = "system.xml:2: warning: <?xml ...?> stands further down; expected it at the very beginning of the file, or left out\n"
    assert (result.returncode, result.stderr) == (0, warning)
    result = compile_text(text.replace("<particle ", "<particel "), tmp_path)
    assert result.returncode == 1 and f"system.xml:{text[:text.index('<particle ')].count(chr(10)) + 1}: " in result.stderr


def test_a_missing_file_is_reported_once(tmp_path):
    result = lagc("missing.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (1, "missing.xml: cannot be read; expected an XML file\n")


def test_other_encodings_that_a_file_names(tmp_path):
    (tmp_path / "system.xml").write_bytes(RIGHT.encode("utf-16"))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_unit_checks_need_units(tmp_path):
    result = compile_text(re.sub(' unit="[^"]*"', "", RIGHT), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_linearization_at_a_pole(tmp_path):
    (tmp_path / "system.xml").write_text(broken(8, "<potential>m*g*l*log(theta)</potential>"))
    result = lagc("--linearize", "system.xml", "--at", "theta=0", cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(r"system.xml:6: the equation of der\(omega\) has a coefficient that is not finite", result.stderr)


COHERENT = "coherent SI units such as kg, m, s, rad, N, J, W, Hz, joined by '.' and '/', for example kg.m2/s2 or N/(m.s)"


@pytest.mark.parametrize("unit, remedy", [
    ("cm", "m, and the value times 1e-2"),
    ("cm2", "m2, and the value times 1e-4"),
    ("cm-1", "m-1, and the value times 1e2"),
    ("kg.cm2", "kg.m2, and the value times 1e-4"),
    ("g/cm3", "kg/m3, and the value times 1e3"),
    ("N/cm", "N/m, and the value times 1e2"),
    ("km/h", "m/s, and the value times 1/3.6"),
    ("km/h2", "m/s2, and the value times 1/12960"),
    ("1/min", "1/s, and the value times 1/60"),
    ("min", "s, and the value times 60"),
    ("kN/m", "N/m, and the value times 1e3"),
    ("N/(mm.min)", "N/(m.s), and the value times 1/0.06"),
    ("deg/s", "rad/s, and the value times pi/180"),
    ("°/s", "rad/s, and the value times pi/180"),
    ("deg2", "rad2, and the value times pi^2/32400"),
    ("N.m/deg", "N.m/rad, and the value times 180/pi"),
    ("rpm", "rad/s, and the value times pi/30"),
    ("mm/s2", "m/s2, and the value times 1e-3"),
    ("N.cm", "N.m, and the value times 1e-2"),
    ("Nm/rad", "N.m/rad, with a point between units"),
    ("meter/sec", "m/s"),
    ("rpm/s", COHERENT),
    ("rpm2", COHERENT),
    ("Nm2", COHERENT),
    ("1/Nm", COHERENT),
    ("cm.lbs", COHERENT),
    ("cm21", COHERENT),
    ("%/s", "1/s, and the value times 1e-2"),
])  # fmt: skip
def test_values_in_other_units(unit, remedy, tmp_path):
    """The message names the factor to SI units; the expected factors are computed by hand."""
    result = compile_text(broken(2, f'<parameter name="m" start="1" unit="{unit}"/>'), tmp_path)
    assert result.stderr == f"system.xml:2: the unit '{unit}' is not known; expected {remedy}\n"


def test_too_many_nested_loops(tmp_path):
    """lagc reports the loop once, and nothing about the unread rest of the file."""
    inner = '<for index="k" from="1" to="10000"></for>'
    loops = f'<for index="i" from="1" to="10000">\n<for index="j" from="1" to="10000">\n{inner}</for></for>\n'
    result = compile_text(broken(11, loops + '<solver method="erk" tolerance="1e-8"/>'), tmp_path)
    assert re.fullmatch("system.xml:13: <for>: the system is too large: more than .* steps .*; expected fewer .*\n", result.stderr), result.stderr


def test_several_errors_in_one_run(tmp_path):
    text = broken(8, "<potential>m*G*bob.y</potential>").replace(">tau<", ">tua<").replace('unit="m/s2"', 'unit="gal"')
    result = compile_text(text, tmp_path)
    assert re.findall(r"system.xml:(\d+):", result.stderr) == ["4", "8", "9"]


def test_one_mistake_in_a_long_loop(tmp_path):
    """lagc prints the first hundred messages, each with its suggestion, and searches no suggestions for the others."""
    loop = '<for index="i" from="1" to="10000"><parameter name="p[i]" start="1"/><potential>q[i]*bob.y</potential></for>'
    result = compile_text(broken(11, loop), tmp_path)
    lines = result.stderr.splitlines()
    assert result.returncode == 1 and len(lines) == 101
    assert all(f"unknown name 'q[{i}]'; did you mean 'p[{i}]'?" in line for i, line in enumerate(lines[:100], 1))
    assert lines[100] == "system.xml: more errors follow; correct these first"


def test_old_output_goes_when_the_system_breaks(tmp_path):
    """An invalid system.xml removes the old system.c, which the build would otherwise compile."""
    compile_text(RIGHT, tmp_path)
    assert (tmp_path / "out" / "system.c").exists()
    compile_text(broken(8, "<potential>m*G</potential>"), tmp_path)
    assert not (tmp_path / "out" / "system.c").exists()


@pytest.mark.parametrize(
    "words, message",
    [
        (["missing.xml", "-o", "out"], "missing.xml.*expected an XML file"),
        (["system.xml", "-o", "/proc/nothing"], "cannot write into"),
        (["system.xml", "-o", "out", "--solver", "euler"], "euler.*expected taylor, erk, bdf, radau, auto or exact"),
        (["system.xml", "-o", "out", "-D", "N=3"], "no <constant> of this name"),
        (["--linearize", "system.xml", "--at", "alpha=1"], "'alpha'"),
        (["--linearize", "system.xml", "--at", "m=1"], "'m'; expected a coordinate, a velocity, a state or an input"),
        (["--linearize", "system.xml", "--at", "theta"], "--at theta names no value; expected NAME=VALUE"),
        (["--linearize", "system.xml", "--at", "theta=30kg"], "--at theta: '30kg' is in kg; expected a value in rad"),
        (["--linearize", "system.xml", "--at", "theta=3furlong"], "--at theta: the unit 'furlong' of '3furlong' is not known; expected a value in rad"),
        (["system.xml"], "usage"),
        (["system.xml", "-o"], "usage"),
        (["--nonsense"], "usage"),
        ([], "usage"),
    ],
)
def test_bad_command_lines(words, message, tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    result = lagc(*words, cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(message, result.stderr)
    assert not (tmp_path / "out").exists()


def test_files_beyond_the_limit_of_the_user(tmp_path):
    """A file-size limit gives one line, as a full disk does, and no partial file."""
    (tmp_path / "system.xml").write_text(RIGHT)
    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)),
    )  # fmt: skip
    assert result.returncode == 1
    assert re.fullmatch("system.xml: cannot write into 'out': File too large; expected .*\n", result.stderr)
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


def test_point_that_is_no_equilibrium(tmp_path):
    """lagc warns: the linear system is then the tangent at the point, with a constant term."""
    (tmp_path / "system.xml").write_text(RIGHT)
    result = lagc("--linearize", "system.xml", "--at", "theta=1", cwd=tmp_path)
    assert result.returncode == 0
    assert re.search("warning: the operating point is not an equilibrium", result.stderr)


LINEARIZATION = '<linearization of="{}" name="Line">\n  <at name="theta" value="0"/>\n{}</linearization>\n'


@pytest.mark.parametrize(
    "of, line, expected",
    [
        ("missing.xml", "", r"missing.xml.*expected an XML file"),
        ("line.xml", "", "line.xml:1: the file linearizes another linearization"),
        ("system.xml", '<at name="theta" value="1"/>\n', "line.xml:3: the operating point sets 'theta' twice"),
        ("system.xml", '<at name="alpha" value="1"/>\n', "line.xml:3: the operating point sets 'alpha'; expected a coordinate"),
        ("system.xml", '<at name="omgea" value="1"/>\n', "line.xml:3: the operating point sets 'omgea', which does not exist; did you mean 'omega'"),
        ("system.xml", '<at name="omega" value="g"/>\n', "line.xml:3: unit mismatch"),
        ("system.xml", '<parameter name="a" start="1"/>\n', "line.xml:3: .*parameter"),
    ],
)
def test_broken_linearizations(of, line, expected, tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    (tmp_path / "line.xml").write_text(LINEARIZATION.format(of, line))
    result = lagc("line.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(expected, result.stderr)
    assert not (tmp_path / "out").exists()


def test_long_and_deep_expressions(tmp_path):
    """lagc accepts 10,000 terms and 1,000 nested parentheses; more parentheses are an error and never crash it."""
    wide = " + ".join(f"{i % 7 + 1}*m*g*bob.y/10000" for i in range(10000))
    deep = "(" * 1000 + "m*g*bob.y" + ")" * 1000
    for expression in (wide, deep):
        result = compile_text(broken(8, f"<potential>{expression}</potential>"), tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
    for nesting in (1001, 100000):
        expression = "(" * nesting + "m*g*bob.y" + ")" * nesting
        result = compile_text(broken(8, f"<potential>{expression}</potential>"), tmp_path)
        assert result.returncode == 1 and "parentheses or powers are nested more than 1000 deep" in result.stderr
    result = compile_text(broken(8, f"<potential>{'-' * 200000}m*g*l</potential>"), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    for text in ("m*g*l" + "^2" * 5000, "cos(" * 5000 + "1" + ")" * 5000):
        result = compile_text(broken(8, f"<potential>{text}</potential>"), tmp_path)
        assert result.returncode == 1 and "system.xml:8: the potential: parentheses or powers are nested more than 1000 deep" in result.stderr


def test_external_entities_are_not_read(tmp_path):
    """A system.xml from elsewhere cannot make lagc read other files."""
    (tmp_path / "secret").write_text("m*g*l")
    text = '<!DOCTYPE system [<!ENTITY secret SYSTEM "secret">]>\n' + broken(8, "<potential>&secret;</potential>")
    result = compile_text(text, tmp_path)
    assert result.returncode == 1 and "m*g*l" not in result.stderr


def test_every_system_compiles_without_messages(name, tmp_path):
    """lagc prints nothing but the notes about the nodes of integrals."""
    result = lagc(ROOT / "fmu" / name / "system.xml", "-o", tmp_path / "out")
    words = re.sub(r"^\S+: note: integral\(.* is exact to 1e-13 by \d+ nodes? near the start values\n", "", result.stderr, flags=re.M)
    assert (result.returncode, result.stdout, words) == (0, "", "")


def names_of(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


FILES = ["documentation/index.html", "documentation/licenses/license.txt", "fmi3/flange.png", "fmi3/flange.svg", "fmi3/icon.svg", "fmi3/modelDescription.xml",
         "fmi3/terminalsAndIcons.xml", "model.png", "modelDescription.xml", "system.c"]


@pytest.mark.parametrize("limit", [0, 1, 4096, 7000])
def test_stopped_while_it_writes(limit, tmp_path):
    """An interrupted run leaves no partial output that the build would use, whichever file exceeded the limit."""
    compile_text(RIGHT, tmp_path)
    before = {name: (tmp_path / "out" / name).read_bytes() for name in FILES}
    assert limit < max(map(len, before.values()))
    (tmp_path / "system.xml").write_text(RIGHT.replace("height", "level"))
    words = [LAGC, "system.xml", "-o", "out"]
    result = subprocess.run(
        words, cwd=tmp_path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    )
    assert result.returncode == 1 and names_of(tmp_path / "out") == []
    assert subprocess.run(words, cwd=tmp_path).returncode == 0
    assert names_of(tmp_path / "out") == FILES and b"level" in (tmp_path / "out" / "system.c").read_bytes()


def test_a_full_disk(tmp_path):
    """A failing write without a signal leaves no partial output either."""
    compile_text(RIGHT, tmp_path)

    def fill():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, preexec_fn=fill, restore_signals=False, capture_output=True
    )
    assert result.returncode == 1 and b"cannot write into 'out': File too large" in result.stderr
    assert names_of(tmp_path / "out") == []


def test_a_file_that_cannot_be_replaced(tmp_path):
    (tmp_path / "out" / "modelDescription.xml").mkdir(parents=True)
    (tmp_path / "out" / "modelDescription.xml" / "mine").write_text("")
    result = compile_text(RIGHT, tmp_path)
    assert result.returncode == 1 and "cannot write into 'out'" in result.stderr
    assert names_of(tmp_path / "out") == ["modelDescription.xml/mine"]


def test_without_memory(tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT.replace("</system>", '<for index="i" from="1" to="10000"><output name="y[i]">sin(i*theta)*exp(theta/i)*der(omega)</output></for></system>'))
    limit = 80 << 20
    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )  # fmt: skip
    assert result.returncode == 1 and re.fullmatch("system.xml: error: out of memory: .*; expected .*\n", result.stderr)
    assert not (tmp_path / "out" / "system.c").exists()


def test_version():
    result = lagc("--version")
    assert result.returncode == 0 and re.fullmatch(r"lagc \d+\.\d+\.\d+\n", result.stdout)


def test_the_point_may_contain_functions_with_commas(tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    results = [
        lagc("--linearize", "system.xml", "--at", point, cwd=tmp_path)
        for point in ("theta=atan2(0, 2),omega=max(0, min(0, 1)),tau=0", "theta=0,omega=0,tau=0")
    ]
    assert results[0].returncode == 0 and results[0].stdout == results[1].stdout


def test_numbers_without_rounding_errors(tmp_path):
    """-0.3/3 is -0.09999999999999999 in doubles; the output has -0.1."""
    (tmp_path / "system.xml").write_text(
        '<system name="P"><coordinate name="x" velocity="v"/><kinetic>v^2/2</kinetic><force coordinate="x">-0.3*x/3</force></system>'
    )
    result = lagc("--linearize", "system.xml", cwd=tmp_path)
    assert result.stdout.count("[-0.1, 0]") == 2 and "9999" not in result.stdout


def test_units_with_roots(tmp_path):
    """Units in FMI have integer exponents: the root of a metre has no unit, and the product of three cube roots is a metre."""
    outputs = '<output name="a">sqrt(l)</output><output name="b">sqrt(l)*sqrt(l)</output><output name="c">l^(1/3)*l^(1/3)*l^(1/3)</output>'
    result = compile_text(broken(10, outputs), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    text = (tmp_path / "out" / "modelDescription.xml").read_text()
    units = dict(re.findall(r'<ScalarVariable name="([abc])".*?<Real(?: declaredType="SI.Length")?(?: unit="(.*?)")?/>', text, re.S))
    assert units == {"a": "", "b": "m", "c": "m"} and "0.5" not in text.split("ModelVariables")[0]
