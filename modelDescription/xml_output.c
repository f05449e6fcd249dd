#include "xml_output.h"

#include "algebra/formula.h"

void write_attribute(xmlTextWriterPtr writer, const char *name, const char *value) {
  xmlTextWriterWriteAttribute(writer, BAD_CAST name, BAD_CAST value);
}

void write_number(xmlTextWriterPtr writer, const char *name, double value) {
  char text[NUMBER_LENGTH];
  number_text(value, text);
  write_attribute(writer, name, text);
}
