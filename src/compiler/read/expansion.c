/*
 * Expansion of <for> and <include>. A depth-first traversal of the document appends every other element to
 * reader->occurrences, with its file and its enclosing loops. A <for> repeats its content once per value of its index;
 * an <include> continues in the document of the file, with a prefix for its names. Later passes iterate over this list.
 * They restore file, prefix and indices for each element, so that no pass repeats the expansion.
 *
 * The traversal ends because loops have at most REPETITION_LIMIT repetitions, and files cannot include themselves.
 * Nested loops multiply, so each step also counts units of work, and the graph's limit of work ends the expansion. The
 * cost is linear in the number of expanded elements.
 */
#include "read/stages.h"

#include <math.h>

#include "base/memory.h"
#include "read/context/includes.h"
#include "read/elements/elements.h"
#include "names/definitions.h"

/* Largest number of repetitions of a <for>; units of work of a repetition, an include and an element. */
enum { REPETITION_LIMIT = 10000, REPETITION_WORK = 40, INCLUDE_WORK = 2000, ELEMENT_WORK = 1000 };

/* Bound of indices, all of which are exact in a double. */
static const double index_limit = 1e9;

/*
 * States of a <for>, stored as addresses in its field _private. rejected: it has an error. backwards: it always ran
 * from a larger to a smaller number. repeated: it ran at least once.
 */
static char rejected, backwards, repeated;

static void expand_children(struct Reader *reader, xmlNodePtr parent);

static void report_index(struct Reader *reader, xmlNodePtr node) {
  char *index = attribute(node, "index");
  report_at(reader, node, "the index '%s' of <for> is already defined; expected another name", index);
}

/* True if the bounds are valid and the index is a new name; reports an error otherwise. */
static bool check_repetition(struct Reader *reader, xmlNodePtr node, const char *index, double from, double to) {
  bool are_whole = from == floor(from) && to == floor(to) && fmax(fabs(from), fabs(to)) < index_limit;
  if (!are_whole || to - from >= REPETITION_LIMIT) {
    report_at(reader, node,
              "<for> runs from %.17g to %.17g; expected whole numbers below 1e9 and at most %d repetitions", from, to,
              REPETITION_LIMIT);
    return false;
  }
  if (scope_find(reader->scope, index) == NULL) return true;
  report_index(reader, node);
  return false;
}

/* Reports a limit that was reached in a <for>, at the innermost one. */
static void check_limit(struct Reader *reader, xmlNodePtr node) {
  const char *limit = graph_limit(reader->model->graph);
  if (limit != NULL && reader->diagnostics->errors == 0)
    report_at(reader, node, "<for>: the system is too large: %s; expected fewer or shorter repetitions", limit);
}

static void expand_repetition(struct Reader *reader, xmlNodePtr node) {
  struct Scope *scope = reader->scope;
  double from = 0, to = -1;
  if (node->_private == &rejected) return;
  char *index_name = attribute(node, "index"), *index = scope_full_name(scope, index_name);
  if (!number_attribute(reader, node, "from", &from) || !number_attribute(reader, node, "to", &to) ||
      !check_repetition(reader, node, index, from, to)) {
    node->_private = &rejected;
    return;
  }
  if (from <= to) node->_private = &repeated;
  else if (to < from - 1 && node->_private == NULL) node->_private = &backwards;
  for (double i = from; i <= to && node->_private != &rejected && graph_limit(reader->model->graph) == NULL; i++) {
    graph_work(reader->model->graph, REPETITION_WORK);
    scope_set_index(scope, index, i);
    definitions_enter(reader->definitions,
                      (struct Loop){.index = index, .value = i, .node = node, .source = reader->source});
    expand_children(reader, node);
    definitions_leave(reader->definitions);
  }
  check_limit(reader, node);
  scope_remove(scope, index);
}

/*
 * Warns of loops that always run backwards. Empty ranges alone are fine: from="1" to="0" repeats nothing in a system
 * with N = 0, and from="2" to="i-1" nothing for i = 1.
 */
static void check_repetitions(struct Reader *reader, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    check_repetitions(reader, node);
    if (node->_private != &backwards) continue;
    char *from = attribute(node, "from"), *to = attribute(node, "to");
    report_warning(reader->diagnostics, line_of(node),
                   "<for> from %s to %s runs backwards: nothing in it is read; expected the smaller number first", from,
                   to);
  }
}

static void expand_include(struct Reader *reader, xmlNodePtr node) {
  struct Graph *graph = reader->model->graph;
  graph_work(graph, INCLUDE_WORK);
  struct Source *source = graph_limit(graph) == NULL ? include_open(reader, node) : NULL;
  if (source == NULL) return;
  struct Source *outer = source_enter(reader, source);
  expand(reader, source->root);
  source_enter(reader, outer);
}

static void expand_element(struct Reader *reader, xmlNodePtr node) {
  size_t number = reader->occurrence_count++;
  reader->occurrences = make_room(reader->occurrences, number, sizeof *reader->occurrences);
  reader->present = &reader->occurrences[number];
  *reader->present = (struct Occurrence){node, reader->source, reader->definitions->present, 0};
  read_element(reader, node, DECLARATIONS);
}

static void expand_children(struct Reader *reader, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    graph_work(reader->model->graph, ELEMENT_WORK);
    if (is_element(node, "for")) expand_repetition(reader, node);
    else if (is_element(node, "include")) expand_include(reader, node);
    else expand_element(reader, node);
  }
}

void expand(struct Reader *reader, xmlNodePtr root) {
  expand_children(reader, root);
  check_repetitions(reader, root);
}

/* True if every <for> around an element is valid. Reports indices that collide with names defined meanwhile. */
static bool check_loops(struct Reader *reader, const struct Loop *loops) {
  const struct Loop *taken = NULL;
  for (const struct Loop *loop = loops; loop != NULL; loop = loop->outer) {
    if (loop->node->_private == &rejected) return false;
    if (scope_find(reader->scope, loop->index) != NULL) taken = loop;
  }
  if (taken == NULL) return true;
  taken->node->_private = &rejected;
  source_enter(reader, taken->source);
  report_index(reader, taken->node);
  return false;
}

static void read_occurrence(struct Reader *reader, struct Occurrence *occurrence, enum Pass pass) {
  const struct Loop *loops = occurrence->loops;
  if (loops != NULL && (graph_limit(reader->model->graph) != NULL || !check_loops(reader, loops))) return;
  source_enter(reader, occurrence->source);
  reader->present = occurrence;
  reader->definitions->present = loops;
  bind_indices(reader->scope, loops);
  read_element(reader, occurrence->node, pass);
  unbind_indices(reader->scope, loops);
  if (loops == NULL) return;
  source_enter(reader, loops->source);
  check_limit(reader, loops->node);
}

void read_expanded(struct Reader *reader, enum Pass pass) {
  struct Source *own = reader->source;
  for (size_t i = 0; i < reader->occurrence_count; i++) {
    graph_work(reader->model->graph, ELEMENT_WORK);
    read_occurrence(reader, &reader->occurrences[i], pass);
  }
  reader->definitions->present = NULL;
  source_enter(reader, own);
}
