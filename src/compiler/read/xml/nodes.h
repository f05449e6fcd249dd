/* What the elements of a document say, as strings. */
#ifndef NODES_H
#define NODES_H

#include <stdbool.h>

#include <libxml/tree.h>

/* Whether the element has this name, and whether it has an attribute of this name. */
bool is_element(xmlNodePtr node, const char *name);
bool has_attribute(xmlNodePtr node, const char *name);

/* NULL where missing; to be freed with free(). */
char *attribute(xmlNodePtr node, const char *name);

/* The element's text, in which a comment separates what stands before and after it; to be freed with free(). */
char *text_of(xmlNodePtr node);

/* Whether it describes a robot in place of a system. */
bool is_robot(xmlDocPtr document);

#endif
