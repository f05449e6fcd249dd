/* Attributes with xmlTextWriter. */
#ifndef XML_OUTPUT_H
#define XML_OUTPUT_H

#include <libxml/xmlwriter.h>

void write_attribute(xmlTextWriterPtr writer, const char *name, const char *value);

/* A number in the shortest form that reads back the same. */
void write_number(xmlTextWriterPtr writer, const char *name, double value);

#endif
