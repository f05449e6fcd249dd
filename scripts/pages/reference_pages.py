"""
Make the pages of the site for the reference of the language.

fmu/README.md is cut into a page for each section. Each element has a page with its attributes, their values, and its parents, from fmu/system.xsd.
The module also lists the names on the page about the Python package.
"""

import posixpath
import re
from dataclasses import dataclass

from scripts.library.live_page.schema import XS, Schema, documentation, enumerated

REFERENCE, FOLDER = "fmu/README.md", "fmu/reference"
# Descriptions for readers of the values of an attribute, by its type in the schema. Other types list their values.
VALUES = {"xs:string": "text", "xs:boolean": "`true` or `false`", "xs:double": "number", "positive": "number above 0", "number": "number, or expression of constants", "expression": "expression",
          "variableName": "name", "systemName": "name", "reference": "name of another element"}  # fmt: skip

# The public functions and classes of the Python package, whose docstrings make a page.
PYTHON = {"lagrange_fmu": ["simulate", "run", "start", "sweep", "live", "linearize", "equilibrium", "fit", "sensitivities", "gradient", "from_sympy", "words"],
          "lagrange_fmu.building": ["build", "check", "new"], "lagrange_fmu.session": ["Simulation"], "lagrange_fmu.results": ["Result"],
          "lagrange_fmu.linearization": ["Linearization"], "lagrange_fmu.equilibria": ["Equilibrium"], "lagrange_fmu.fit_result": ["Fit"],
          "lagrange_fmu.variational": ["Sensitivities"], "lagrange_fmu.adjoint": ["Gradient"]}  # fmt: skip


def values_of(attribute):
    """Return the words for the values of an attribute."""
    if enumerated(attribute):
        return ", ".join(f"`{value}`" for value in enumerated(attribute))
    return "`#rrggbb`" if attribute.find(f"{XS}simpleType") is not None else VALUES[attribute.get("type")]


@dataclass
class Section:
    """A part of the reference, from its heading to the next one of any level. The text before the first heading has the anchor ""."""

    anchor: str
    title: str
    text: str
    page: str  # the path of the page that it is on


def sections_of(text):
    """Return the sections of the reference, in its order. Headings of the second level begin a page."""
    sections, page = [], REFERENCE
    for part in re.split(r"^(?=##+ )", text, flags=re.M):
        heading = part.splitlines()[0] if sections else ""
        title = heading.lstrip("# ")
        anchor = re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")
        page = f"{FOLDER}/{anchor}.md" if heading.startswith("## ") else page
        sections.append(Section(anchor, title, part, page))
    return sections


def page_of(anchor, sections):
    """Return the page of an anchor of the reference, with the anchor on it."""
    section = next(section for section in sections if section.anchor == anchor)
    return section.page if section.page == f"{FOLDER}/{anchor}.md" else f"{section.page}#{anchor}"


def relink(text, old, new, sections):
    """Return a page that has moved from old to new, with links to the same targets as before. Links to the reference lead to its parts."""

    def link(match):
        path, _, anchor = match.group(1).partition("#")
        if re.match(r"\w+:", path):
            return match.group(0)
        target = posixpath.normpath(posixpath.join(posixpath.dirname(old), path)) if path else old
        if target == REFERENCE and anchor:
            target, _, anchor = page_of(anchor, sections).partition("#")
        place = "" if target == new and anchor else posixpath.relpath(target, posixpath.dirname(new) or ".")
        return f"]({place}{'#' * bool(anchor)}{anchor})"

    # Code holds no links.
    parts = re.split(r"(^```.*?^```)", text, flags=re.M | re.S)
    return "".join(part if part.startswith("```") else re.sub(r"\]\(([^()\s]+)\)", link, part) for part in parts)


def rows_of_elements(sections):
    """Yield the rows of the reference's table of elements, each as the anchors of its elements by their names."""
    for row in re.findall(r"^\| .*?<.*\|$", sections[0].text, re.M):
        yield {name: anchor for names, anchor in re.findall(r"\[(`<.*?)\]\(#([\w-]+)\)", row) for name in re.findall(r"<(\w+)", names)}


def example_of(name, page, sections):
    """Return the shortest example of a file with an element, preferably from this page of the reference; "" if there is none."""

    def examples(parts):
        blocks = [block for part in parts for block in re.findall(r"^```xml\n<(?:system|linearization).*?^```$", part.text, re.M | re.S)]
        return [block for block in blocks if re.search(rf"<{name}\b", block)]

    return min(examples(part for part in sections if part.page == page) or examples(sections), key=len, default="")


def element_page(name, row, schema, sections):
    """
    Return the page of an element as Markdown, whose links are those of a page in fmu/. `row` has the elements in the same row of the table of
    elements.
    """
    lines = [f"# `<{name}>`", ""]
    for parents, declaration in schema.kinds(name):
        sentence, attributes, contents, has_text = schema.frame(declaration)
        where = f"Stands in {', '.join(map(link_of, sorted(set(parents))))}." if parents else "It is the root of a file."
        inside = ["text"] * has_text + list(map(link_of, contents))
        lines += [sentence, "", where + f" Contains {', '.join(inside)}." * bool(inside), ""]
        if attributes:
            lines += ["| attribute (**needed**) | value | meaning |", "| --- | --- | --- |", *map(row_of, attributes), ""]
    section = next(section for section in sections if section.anchor == row[name])
    lines += [f"The rules and the mathematics are in [{section.title}](README.md#{section.anchor}).", ""]
    example = example_of(name, section.page, sections)
    lines += ["## Example", "", example, ""] * bool(example)
    others = [link_of(other) for other in row if other != name and other in schema.elements]
    return "\n".join(lines + [f"See also {', '.join(others)}.", ""] * bool(others))


def link_of(element):
    return f"[`<{element}>`](elements/{element}.md)"


def row_of(attribute):
    """Return the row of an attribute in the table of its element."""
    name = attribute.get("name")
    return f"| {f'**{name}**' if attribute.get('use') == 'required' else name} | {values_of(attribute)} | {documentation(attribute)} |"


def reference_pages(text, schema_text):
    """
    Return the pages of the reference: texts by path, and the navigation, a list of titles with paths.

    Their links are adapted to the new paths; links in other pages of the site are adapted by relink().
    """
    sections, schema = sections_of(text), Schema(schema_text)
    pages = {}
    for section in sections:
        pages[section.page] = pages.get(section.page, "") + section.text
    navigation = {"Overview": REFERENCE} | {section.title: section.page for section in sections if section.text.startswith("## ")}
    # A page begins with a heading of the first level.
    pages = {page: relink(re.sub(r"^#(?=#)", "", text, flags=re.M) if page != REFERENCE else text, REFERENCE, page, sections) for page, text in pages.items()}
    for row in rows_of_elements(sections):
        for name in row:
            if name in schema.elements:
                page = f"fmu/elements/{name}.md"
                pages[page] = relink(element_page(name, row, schema, sections), REFERENCE, page, sections)
    return pages, navigation
