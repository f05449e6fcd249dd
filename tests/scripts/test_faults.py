"""The mutations of scripts/checks/faults on short texts of C."""

import subprocess
import sys

import pytest

from fmu import ROOT

sys.path.append(str(ROOT / "tests" / "faults"))
from mutations import changed_lines, line_of, mutants_of, mutated
from planting import name_in, planted_text


def mutations_of(body):
    """Return the bodies of a function's mutants by kind."""
    source = f"int f(int a, double x)\n{{{body}}}\n".encode()
    found = {}
    for mutant in mutants_of(source):
        found.setdefault(mutant.kind, []).append(mutated(source, mutant).decode().split("{", 1)[1].rsplit("}", 1)[0])
    return found


@pytest.mark.parametrize("body, expected", [
    ("return a + x;", {"arithmetic": ["return a - x;"]}),
    ("x *= a; return x;", {"arithmetic": ["x /= a; return x;"], "dropped": ["; return x;"]}),
    ("return a <= x;", {"bound": ["return a < x;"]}),
    ("return a > x;", {"bound": ["return a >= x;"]}),
    ("return a == x;", {"equality": ["return a != x;"]}),
    ("return a && x;", {"logical": ["return a || x;"]}),
    ("return !a;", {"logical": ["return a;"]}),
    ("return -x;", {"sign": ["return x;"]}),
    ("return 7;", {"constant": ["return 8;"]}),
    ("return 7u;", {"constant": ["return 8u;"]}),
    ("return 1e-3;", {"constant": ["return (10 * 1e-3);"]}),
    ("return 0.0;", {"constant": ["return 1.0;"]}),
    ("if (a) return x; return a;", {"condition": ["if (0) return x; return a;", "if (1) return x; return a;"], "dropped": ["if (a) ; return a;"]}),
    ("return a ? x : a;", {"condition": ["return (0) ? x : a;", "return (1) ? x : a;"]}),
    ("while (a) a--; return a;", {"condition": ["while (0) a--; return a;"], "dropped": ["while (a) ; return a;"]}),
    ("for (;;) break;", {"dropped": ["for (;;) ;"]}),
    ("for (;;) continue;", {"dropped": ["for (;;) ;"]}),
    ("f(a, x); return a;", {"dropped": ["; return a;"]}),
    ("return a;", {}),
    ("int b = a; /* a + 1 */ puts(\"a < 1\"); return b; // a == 2", {"dropped": ["int b = a; /* a + 1 */ ; return b; // a == 2"]}),
])  # fmt: skip
def test_mutations(body, expected):
    assert mutations_of(body + "\n") == {kind: [text + "\n" for text in texts] for kind, texts in expected.items()}


def test_declarations_stay():
    assert mutants_of(b'#define N (1 + 2)\nstatic const double table[] = {1.5, -2};\nextern int g(int a);\nenum { A = 1 << 3 };\n') == []


DIFFERENCE = """\
diff --git a/src/one.c b/src/one.c
--- a/src/one.c
+++ b/src/one.c
@@ -3 +3,2 @@ int f(void)
-  return 1;
+  int b = 2;
+  return b;
@@ -10,2 +11,0 @@ int g(void)
-  a();
-  b();
--- /dev/null
+++ b/src/two.c
@@ -0,0 +1 @@
+int h(void) { return 4; }
"""


def test_lines_of_a_difference():
    assert changed_lines(DIFFERENCE) == {"src/one.c": {3, 4}, "src/two.c": {1}}


def test_line_of_a_mutant():
    source = b"int f(int a)\n{\n  a = 0;\n  return a + a;\n}\n"
    assert [(line_of(source, mutant), mutant.kind) for mutant in mutants_of(source)] == [(3, "dropped"), (3, "constant"), (4, "arithmetic")]


SUM = b"""\
static double total(int n)
{
  double sum = 0.0;
  for (int i = 0; i < n; i++) sum += i;
  return sum;
}
int main(void)
{
  printf("%g", total(4));
  return 0;
}
"""


def test_the_environment_chooses_a_mutant(tmp_path):
    """The program with all mutants prints without one what the original prints, 0 + 1 + 2 + 3, and with one what its text says."""
    mutants = {number: mutant for number, mutant in enumerate(mutants_of(SUM), 1) if mutant.body[0] < SUM.index(b"main")}
    (tmp_path / "sum.c").write_bytes(planted_text("sum.c", SUM, mutants))
    subprocess.run(["gcc", "-Wall", "-Werror", "sum.c", "-o", "sum"], cwd=tmp_path, check=True)
    (tmp_path / "reached").mkdir()

    def printed(**environment):
        return subprocess.run(["./sum"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True).stdout

    results = {mutated(SUM, mutant): printed(PLANTED_FAULT=str(number)) for number, mutant in mutants.items()}
    assert printed(PLANTED_REACHED=str(tmp_path / "reached")) == "6"
    assert {path.name for path in (tmp_path / "reached").iterdir()} == {f"{name_in('sum.c')}.{index}" for index in (0, 1)}
    assert {wrong: results[SUM.replace(right, wrong)] for right, wrong in [
        (b"sum += i;", b"sum -= i;"), (b"i < n", b"i <= n"), (b"i = 0", b"i = 1"), (b"sum += i;", b";"), (b"0.0", b"1.0"),
    ]} == {b"sum -= i;": "-6", b"i <= n": "10", b"i = 1": "6", b";": "0", b"1.0": "7"}  # fmt: skip
