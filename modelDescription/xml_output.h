#pragma once

#include <libxml/xmlwriter.h>
#include <stdbool.h>

/* Begins an indented document in the buffer; NULL if libxml2 reports an error. */
xmlTextWriterPtr open_document(xmlBufferPtr buffer, const char *root);

/* Ends the document and frees the writer. Returns false if libxml2 reports an error. */
bool close_document(xmlTextWriterPtr writer);

/* Writes an attribute, with special characters escaped. */
void write_attribute(xmlTextWriterPtr writer, const char *name, const char *value);

/* Writes a number in the shortest form that reads back the same. */
void write_number(xmlTextWriterPtr writer, const char *name, double value);
