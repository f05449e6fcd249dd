#include "robots/expansion/mjcf_files.h"

#include <stddef.h>

#include "xml/lines.h"
#include "xml/xml.h"

struct FileLine mjcf_switch_file(struct Diagnostics *diagnostics, struct FileLine place) {
  struct FileLine former = {diagnostics->file, diagnostics->origin, 0};
  diagnostics->file = place.file;
  diagnostics->origin = place.origin;
  return former;
}

xmlDocPtr mjcf_load(struct Diagnostics *diagnostics, struct FileLine place) {
  struct FileLine former = mjcf_switch_file(diagnostics, place);
  xmlDocPtr document = xml_read(place.file, diagnostics);
  mjcf_switch_file(diagnostics, former);
  return document;
}

/* Sets the lines of a copied node and its descendants. of_file: NULL for originals in the same file. */
static void set_lines(const struct Diagnostics *of_file, long line, xmlNodePtr copy, const xmlNode *original) {
  long own = line_of(original), noted = of_file != NULL ? note_line(of_file, own) : own;
  set_line(copy, of_file == NULL || of_file->noted != NULL ? noted : line);
  if (copy->type != XML_ELEMENT_NODE) return;
  for (xmlNodePtr a = copy->children, b = original->children; a != NULL && b != NULL; a = a->next, b = b->next)
    set_lines(of_file, line, a, b);
}

xmlNodePtr mjcf_copy(const struct Diagnostics *of_file, long line, xmlNodePtr node, xmlDocPtr document) {
  xmlNodePtr copy = xmlDocCopyNode(node, document, 1);
  set_lines(of_file, line, copy, node);
  return copy;
}

xmlNodePtr mjcf_copy_within(xmlNodePtr node) {
  return mjcf_copy(NULL, 0, node, node->doc);
}
