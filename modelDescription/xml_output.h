/* Documents and attributes with xmlTextWriter. */
#pragma once

#include <libxml/xmlwriter.h>
#include <stdbool.h>

/* Begins an indented document with its root in the buffer; NULL where libxml2 reports an error. */
xmlTextWriterPtr open_document(xmlBufferPtr buffer, const char *root);

/* Ends and frees it. Returns false where libxml2 reports an error. */
bool close_document(xmlTextWriterPtr writer);

void write_attribute(xmlTextWriterPtr writer, const char *name, const char *value);

/* A number in the shortest form that reads back the same. */
void write_number(xmlTextWriterPtr writer, const char *name, double value);
