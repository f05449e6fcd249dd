"""Read fmu/system.xsd: the elements of the language, their attributes, and the sentences about them."""

import xml.etree.ElementTree as tree

XS = "{http://www.w3.org/2001/XMLSchema}"


class Schema:
    """fmu/system.xsd: the elements of the language, with their attributes and children."""

    def __init__(self, text):
        self.root = tree.fromstring(text)
        self.named = {(node.tag, node.get("name")): node for node in self.root if node.get("name")}
        self.elements = {}  # declarations by name; an element may mean different things in different parents
        for node in self.root.iter(f"{XS}element"):
            self.elements.setdefault(node.get("name"), []).append(node)

    def type_of(self, declaration):
        """Return the complex type of an element, or None if it has only text."""
        inline = declaration.find(f"{XS}complexType")
        return inline if inline is not None else self.named.get((f"{XS}complexType", declaration.get("type")))

    def bases(self, node):
        """Yield a type, and the types that it extends, the base first."""
        for extension in node.iter(f"{XS}extension"):
            base = self.named.get((f"{XS}complexType", extension.get("base")))
            if base is not None:
                yield from self.bases(base)
        yield node

    def attributes(self, node):
        """Yield the declarations of a type's attributes, in the order of the schema, without those of contained elements."""
        for child in node:
            if child.tag == f"{XS}attribute":
                yield child
            elif child.tag == f"{XS}attributeGroup":
                yield from self.attributes(self.named[(f"{XS}attributeGroup", child.get("ref"))])
            elif child.tag in (f"{XS}complexContent", f"{XS}simpleContent", f"{XS}extension"):
                yield from self.attributes(child)

    def children(self, node):
        """Yield the names of the elements that a type contains."""
        for child in node:
            if child.tag == f"{XS}element":
                yield child.get("name")
            elif child.tag == f"{XS}group":
                yield from self.children(self.named[(f"{XS}group", child.get("ref"))])
            elif child.tag in (f"{XS}choice", f"{XS}sequence"):
                yield from self.children(child)

    def kinds(self, name):
        """Return pairs of parents and a declaration, one for each type that an element has; that of a <system> first."""
        kinds = {}
        for parent, declarations in self.elements.items():
            types = filter(None, map(self.type_of, declarations))
            for declaration in (found for node in types for found in self.found_in(node, name)):
                kinds.setdefault(declaration.get("type") or id(declaration), ([], declaration))[0].append(parent)
        return sorted(kinds.values(), key=lambda kind: "system" not in kind[0]) or [([], self.elements[name][0])]

    def found_in(self, node, name):
        """Yield the declarations of an element in a type."""
        for child in node:
            if child.tag == f"{XS}element" and child.get("name") == name:
                yield child
            elif child.tag == f"{XS}group":
                yield from self.found_in(self.named[(f"{XS}group", child.get("ref"))], name)
            elif child.tag in (f"{XS}choice", f"{XS}sequence"):
                yield from self.found_in(child, name)

    def frame(self, declaration):
        """Return the sentence about an element, its attributes, the names of its children, and whether it has text."""
        node = self.type_of(declaration)
        if node is None:
            return documentation(declaration), [], [], True
        attributes = {attribute.get("name"): attribute for part in self.bases(node) for attribute in self.attributes(part)}
        contents = {name: None for part in self.bases(node) for name in self.children(part)}
        has_text = node.get("mixed") == "true" or node.find(f"{XS}simpleContent") is not None
        return documentation(declaration) or documentation(node), list(attributes.values()), list(contents), has_text


def documentation(node):
    """Return the documentation of a declaration; "" if there is none."""
    return node.findtext(f"{XS}annotation/{XS}documentation") or ""


def enumerated(attribute):
    """Return the values that the schema lists for an attribute; an empty list if it lists none."""
    return [value.get("value") for value in attribute.iter(f"{XS}enumeration")]
