/*
 * Line numbers of nodes and attributes. Those of libxml2 do not suffice: an element has the line where its start tag
 * ends, a text the line where it ends. They stop at 65,535, and attributes have none. So the source text is scanned
 * once more, in parallel with the document.
 */
#pragma once

#include <stddef.h>

#include <libxml/tree.h>

/*
 * Finds the lines of all nodes of a document in the text that it was parsed from. Stops where the two disagree, as in
 * files that are not UTF-8; line_of() then falls back on libxml2.
 */
void lines_find(xmlDocPtr document, const char *text, size_t length);

/* Sets the line of a node that was not parsed from the file. */
void set_line(xmlNodePtr node, long line);

/* Returns the line on which a node begins. */
long line_of(const xmlNode *node);

/* Returns the line on which the value of an attribute begins; the line of the element if it has no such attribute. */
long line_of_attribute(const xmlNode *element, const char *name);

/* Returns the line on which the start tag of an element ends and its content begins. */
long line_of_content(const xmlNode *element);

/*
 * Returns a copy of an attribute's value with the line breaks of the file, which XML replaces by blanks. NULL if there
 * is no such attribute.
 */
char *attribute_in_lines(xmlNodePtr element, const char *name);
