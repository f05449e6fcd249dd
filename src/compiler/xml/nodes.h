/* Names, attributes and texts of XML nodes as strings. */
#pragma once

#include <stdbool.h>

#include <libxml/tree.h>

#include "xml/lines.h"

/* True if the node is an element of this name. */
bool is_element(const xmlNode *node, const char *name);

/* True if the element has an attribute of this name; attribute_is(): and if the attribute has this value. */
bool has_attribute(xmlNodePtr node, const char *name);
bool attribute_is(xmlNodePtr node, const char *name, const char *value);

/* Returns a copy of the attribute's value; NULL if the element has no such attribute. */
char *attribute(xmlNodePtr node, const char *name);

/*
 * Returns the text of the element. Each comment in it becomes a blank and the line breaks of the comment. So words stay
 * apart and line numbers stay right.
 */
char *text_of(xmlNodePtr node);

/* True if the document describes a robot (URDF or MJCF) instead of a system; false before its first element is read. */
bool is_robot(xmlDocPtr document);
