#include "robots/expansion/mjcf_includes.h"

#include <errno.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "names/names.h"
#include "xml/nodes.h"
#include "xml/xml.h"

/* Depth of includes; it bounds the depth of the resulting tree. */
enum { DEPTH_LIMIT = 8 };

/* The file being read, and all files read so far. */
struct Inclusion {
  struct Diagnostics *diagnostics;
  const char *robot; /* the robot's file */
  const char *file;
  struct Names *known; /* canonical paths */
  long line;           /* of the <include> in the robot's file; 0 while that is read */
  int depth;
};

/* Returns the path of the file that an <include> names; NULL after reporting an error. */
static char *find_file(struct Inclusion *inclusion, xmlNodePtr node, long line) {
  char *named = attribute(node, "file");
  if (named == NULL || *named == '\0') {
    report_error(inclusion->diagnostics, line, "an <include> names no file; expected file=\"...\"");
    return NULL;
  }
  char *path = path_beside_file(inclusion->robot, named), *canonical = canonical_path(path);
  if (canonical == NULL) {
    path = path_beside_file(inclusion->file, named);
    canonical = canonical_path(path);
  }
  if (canonical == NULL)
    report_error(inclusion->diagnostics, line,
                 "the file '%s' of an <include> cannot be read: %s; expected a path relative to the robot's file",
                 named, strerror(errno));
  else if (inclusion->depth == DEPTH_LIMIT)
    report_error(inclusion->diagnostics, line,
                 "more than %d files include each other in a row; expected fewer, some of them side by side",
                 DEPTH_LIMIT);
  else if (names_find(inclusion->known, canonical) != NULL)
    report_error(inclusion->diagnostics, line,
                 "the file '%s' is included twice, or includes itself; expected each file once", named);
  else {
    names_set(inclusion->known, canonical, path);
    return path;
  }
  return NULL;
}

/* Parses a file. Messages name it by the path at which it was found. */
static xmlDocPtr load(struct Inclusion *inclusion, const char *path, long line) {
  struct Diagnostics *diagnostics = inclusion->diagnostics;
  const char *file = diagnostics->file, *origin = diagnostics->origin;
  diagnostics->origin = format_text(" (included on line %ld of %s)", line, inclusion->robot);
  diagnostics->file = path;
  xmlDocPtr document = xml_read(path, diagnostics);
  diagnostics->file = file;
  diagnostics->origin = origin;
  return document;
}

/*
 * Gives copied nodes the lines of the originals in their own file. If lines are not noted, the copies get the line of
 * the <include>.
 */
static void set_lines(const struct Diagnostics *of_file, long include, xmlNodePtr copy, const xmlNode *original) {
  for (; copy != NULL && original != NULL; copy = copy->next, original = original->next) {
    long line = line_of(original), noted = note_line(of_file, line);
    set_line(copy, of_file->noted != NULL ? noted : include);
    if (copy->type == XML_ELEMENT_NODE) set_lines(of_file, include, copy->children, original->children);
  }
}

static void insert_in(struct Inclusion *inclusion, xmlNodePtr parent);

/* Replaces the <include> by the elements of its file. */
static void replace(struct Inclusion *inclusion, xmlNodePtr node) {
  long line = inclusion->line > 0 ? inclusion->line : line_of(node);
  char *path = find_file(inclusion, node, line);
  xmlDocPtr document = path != NULL ? load(inclusion, path, line) : NULL;
  if (document == NULL) return;
  struct Inclusion inner = *inclusion;
  inner.file = path;
  inner.line = line;
  inner.depth++;
  insert_in(&inner, xmlDocGetRootElement(document));
  struct Diagnostics of_file = *inclusion->diagnostics;
  of_file.origin = format_text(" (included on line %ld of %s)", line, inclusion->robot);
  of_file.file = path;
  xmlNodePtr copies = xmlDocCopyNodeList(node->doc, xmlDocGetRootElement(document)->children);
  set_lines(&of_file, line, copies, xmlDocGetRootElement(document)->children);
  xmlFreeDoc(document);
  while (copies != NULL) {
    xmlNodePtr next = copies->next;
    xmlUnlinkNode(copies);
    xmlAddPrevSibling(node, copies);
    copies = next;
  }
  xmlUnlinkNode(node);
  xmlFreeNode(node);
}

static void insert_in(struct Inclusion *inclusion, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children, next; node != NULL; node = next) {
    next = node->next;
    if (is_element(node, "include")) replace(inclusion, node);
    else insert_in(inclusion, node);
  }
}

void mjcf_insert_files(xmlNodePtr root, struct Diagnostics *diagnostics) {
  struct Inclusion inclusion = {diagnostics, diagnostics->file, diagnostics->file, names_create(), 0, 0};
  char *canonical = canonical_path(diagnostics->file);
  if (canonical != NULL) names_set(inclusion.known, canonical, canonical);
  insert_in(&inclusion, root);
}
