/* What the elements of a document say, as strings. */
#pragma once

#include <stdbool.h>

#include <libxml/tree.h>

#include "read/xml/lines.h"

/* Whether it is an element of this name. */
bool is_element(const xmlNode *node, const char *name);

/* Whether the element has an attribute of this name, and whether that has this value. */
bool has_attribute(xmlNodePtr node, const char *name);
bool attribute_is(xmlNodePtr node, const char *name, const char *value);

/* NULL where missing. */
char *attribute(xmlNodePtr node, const char *name);

/* The element's text, in which the line breaks of a comment, or a blank, separate what stands before and after it. */
char *text_of(xmlNodePtr node);

/* Whether it describes a robot in place of a system. */
bool is_robot(xmlDocPtr document);
