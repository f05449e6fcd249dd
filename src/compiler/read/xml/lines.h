/*
 * The lines on which nodes of a document stand. libxml2 numbers an element by the end of its start tag, a text by that of its
 * end, and nothing beyond 65,535; it keeps no lines of attributes.
 */
#pragma once

#include <stddef.h>

#include <libxml/tree.h>

/* Finds the lines of all nodes in the text from which the document was read. Without effect where that is not UTF-8. */
void lines_find(xmlDocPtr document, const char *text, size_t length);

/* Gives a node that comes from elsewhere its line. */
void set_line(xmlNodePtr node, long line);

/* The line on which a node begins. */
long line_of(const xmlNode *node);

/* The line on which the value of an attribute begins; that of the element where it has none of this name. */
long line_of_attribute(const xmlNode *element, const char *name);

/* The line on which the start tag of an element ends, and its content begins. */
long line_of_content(const xmlNode *element);

/* The value of an attribute, in which the line breaks of the file are in place of the blanks that XML makes of them. */
char *attribute_in_lines(xmlNodePtr element, const char *name);
