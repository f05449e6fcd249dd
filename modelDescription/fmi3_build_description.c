#include <libxml/xmlwriter.h>

#include "fmi3_description.h"
#include "xml_output.h"

bool fmi3_build_description_write(xmlBufferPtr buffer, const struct Program *program) {
  const char *name = program->model->name;
  xmlTextWriterPtr writer = open_document(buffer, "fmiBuildDescription");
  if (writer == NULL) return false;
  write_attribute(writer, "fmiVersion", "3.0");
  xmlTextWriterStartElement(writer, BAD_CAST "BuildConfiguration");
  write_attribute(writer, "modelIdentifier", name);
  xmlTextWriterStartElement(writer, BAD_CAST "SourceFileSet");
  write_attribute(writer, "language", "C11");
  xmlTextWriterStartElement(writer, BAD_CAST "SourceFile");
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "name", "%s.c", name);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
  /* the C math library */
  xmlTextWriterStartElement(writer, BAD_CAST "Library");
  write_attribute(writer, "name", "m");
  write_attribute(writer, "external", "true");
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
  return close_document(writer);
}
