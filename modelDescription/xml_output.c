#include "xml_output.h"

#include "algebra/formula.h"

xmlTextWriterPtr open_document(xmlBufferPtr buffer, const char *root) {
  xmlTextWriterPtr writer = xmlNewTextWriterMemory(buffer, 0);
  if (writer == NULL) return NULL;
  xmlTextWriterSetIndent(writer, 1);
  xmlTextWriterSetIndentString(writer, BAD_CAST "  ");
  xmlTextWriterStartDocument(writer, NULL, "UTF-8", NULL);
  xmlTextWriterStartElement(writer, BAD_CAST root);
  return writer;
}

bool close_document(xmlTextWriterPtr writer) {
  xmlTextWriterEndElement(writer);
  bool written = xmlTextWriterEndDocument(writer) >= 0;
  xmlFreeTextWriter(writer);
  return written;
}

void write_attribute(xmlTextWriterPtr writer, const char *name, const char *value) {
  xmlTextWriterWriteAttribute(writer, BAD_CAST name, BAD_CAST value);
}

void write_number(xmlTextWriterPtr writer, const char *name, double value) {
  char text[NUMBER_LENGTH];
  number_text(value, text);
  write_attribute(writer, name, text);
}
