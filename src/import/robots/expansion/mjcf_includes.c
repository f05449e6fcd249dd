#include "robots/expansion/mjcf_includes.h"

#include <errno.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "names/names.h"
#include "robots/expansion/mjcf_files.h"
#include "xml/nodes.h"

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
  else if (inclusion->depth == MJCF_DEPTH_LIMIT)
    report_error(inclusion->diagnostics, line,
                 "more than %d files include each other in a row; expected fewer, some of them side by side",
                 MJCF_DEPTH_LIMIT);
  else if (names_find(inclusion->known, canonical) != NULL)
    report_error(inclusion->diagnostics, line,
                 "the file '%s' is included twice, or includes itself; expected each file once", named);
  else {
    names_set(inclusion->known, canonical, path);
    return path;
  }
  return NULL;
}

static void insert_in(struct Inclusion *inclusion, xmlNodePtr parent);

/* Replaces the <include> by the elements of its file. */
static void replace(struct Inclusion *inclusion, xmlNodePtr node) {
  long line = inclusion->line > 0 ? inclusion->line : line_of(node);
  char *path = find_file(inclusion, node, line);
  if (path == NULL) return;
  struct FileLine place = {path, format_text(" (included on line %ld of %s)", line, inclusion->robot), 0};
  xmlDocPtr document = mjcf_load(inclusion->diagnostics, place);
  if (document == NULL) return;
  struct Inclusion inner = *inclusion;
  inner.file = path;
  inner.line = line;
  inner.depth++;
  insert_in(&inner, xmlDocGetRootElement(document));
  struct Diagnostics of_file = *inclusion->diagnostics;
  mjcf_switch_file(&of_file, place);
  for (xmlNodePtr child = xmlDocGetRootElement(document)->children; child != NULL; child = child->next)
    xmlAddPrevSibling(node, mjcf_copy(&of_file, line, child, node->doc));
  xmlFreeDoc(document);
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
