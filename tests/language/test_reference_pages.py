"""The pages that the site makes of fmu/README.md and fmu/system.xsd: complete, with links that lead somewhere."""

import ast
import posixpath
import re
import xml.etree.ElementTree as tree

import pytest

from fmu import ROOT, lagc
from scripts.library.live_page.schema import XS, documentation
from scripts.pages.reference_pages import PYTHON, reference_pages, relink, sections_of

TEXT, SCHEMA = ((ROOT / "fmu" / name).read_text() for name in ("README.md", "system.xsd"))
PAGES, CONTENTS = reference_pages(TEXT, SCHEMA)


def test_every_attribute_is_documented():
    attributes = list(tree.fromstring(SCHEMA).iter(f"{XS}attribute"))
    assert len(attributes) > 100
    assert [a.get("name") for a in attributes if not documentation(a).endswith(".")] == []


def test_lagc_has_the_schema_without_its_documentation():
    data = (ROOT / "build" / "bin" / "lagc").read_bytes()
    assert b'<xs:element name="system">' in data and b"<xs:documentation>" not in data


def test_each_element_has_a_page():
    elements = [name for kind, name in map(str.split, lagc("--words").stdout.splitlines()) if kind == "element" and f'name="{name}"' in SCHEMA]
    assert "friction" in elements
    for name in elements:
        page = PAGES[f"fmu/elements/{name}.md"]
        assert page.startswith(f"# `<{name}>`\n\n") and "```xml" in page and "Stands in" in page or name in ("system", "linearization")


def test_an_element_in_two_parents_has_both_meanings():
    page = PAGES["fmu/elements/point.md"]
    space, curve = page.index("A point of a frame"), page.index("A point of the curve")
    assert space < curve and "[`<table>`](table.md)" in page[curve:]
    assert re.search(r"\| \*\*mass\*\* \| expression \| .*\n(\|.*\n)*\| inertia \|", PAGES["fmu/elements/body.md"]), "attributes of <particle>, then those of <body>"
    assert "| `falling`, `rising`, `both` |" in PAGES["fmu/elements/event.md"]


def links(text):
    return re.findall(r"\]\(([^()\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))


def anchors(text):
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in re.findall(r"^#+ (.*)$", text, re.M)}


def test_links_lead_to_pages():
    for page, text in PAGES.items():
        for path, _, anchor in (link.partition("#") for link in links(text) if "://" not in link):
            target = posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page
            assert target in PAGES or (ROOT / target).exists(), (page, target)
            assert not anchor or anchor in anchors(PAGES.get(target) or (ROOT / target).read_text()), (page, target, anchor)


def test_all_of_the_reference_is_on_its_pages():
    lines = {line for text in PAGES.values() for line in text.splitlines() if not re.search(r"\]\(|^#", line)}
    assert {line for line in TEXT.splitlines() if line and not re.search(r"\]\(|^#", line)} <= lines
    assert list(CONTENTS.values()) == list(dict.fromkeys(CONTENTS.values())) and set(CONTENTS.values()) <= set(PAGES)


@pytest.mark.parametrize("link, expected", [
    ("../README.md#friction", "../reference/switching.md#friction"),
    ("../README.md#constraints", "../reference/constraints.md"),
    ("../README.md", "../README.md"),
    ("rope.md#a", "rope.md#a"),
    ("https://example.org/a#friction", "https://example.org/a#friction"),
])  # fmt: skip
def test_links_of_other_pages_lead_to_parts_of_the_reference(link, expected):
    assert relink(f"[a]({link})", "fmu/howto/brake.md", "fmu/howto/brake.md", sections_of(TEXT)) == f"[a]({expected})"
    code = f"```\n[a]({link})\n```"
    assert relink(code, "fmu/howto/brake.md", "fmu/howto/brake.md", sections_of(TEXT)) == code


def test_all_public_python_names_are_on_a_page():
    package = ROOT / "scripts" / "wheel" / "lagrange_fmu"
    public = next(ast.literal_eval(node.value) for node in ast.parse((package / "__init__.py").read_text()).body if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    listed = [name for names in PYTHON.values() for name in names]
    assert set(public) - {"Problem"} <= set(listed)
    for module, names in PYTHON.items():
        file = package / f"{module.removeprefix('lagrange_fmu').removeprefix('.') or '__init__'}.py"
        defined = {node.name: ast.get_docstring(node) for node in ast.parse(file.read_text()).body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        assert all(defined.get(name) for name in names), module
