#include "read/scope.h"

#include <stdlib.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "memory.h"

struct Entry {
  struct Quantity quantity;
  long line; /* of the definition; 0 for names of the language itself */
};

struct Scope *scope_create(struct Graph *graph, struct Diagnostics *diagnostics) {
  struct Scope *scope = allocate(1, sizeof *scope);
  scope->graph = graph;
  scope->diagnostics = diagnostics;
  scope->names = names_create();
  return scope;
}

void scope_free(struct Scope *scope) {
  if (scope == NULL) return;
  names_free(scope->names);
  free(scope->time_derivatives);
  free(scope->requirements.items);
  free(scope);
}

static struct Entry *find_entry(const struct Scope *scope, const char *name) {
  return names_find(scope->names, name);
}

static void add_entry(struct Scope *scope, const char *name, struct Quantity quantity, long line) {
  struct Entry *entry = allocate(1, sizeof *entry);
  *entry = (struct Entry){quantity, line};
  names_set(scope->names, name, entry);
}

bool scope_define(struct Scope *scope, const char *name, struct Quantity quantity, long line) {
  const struct Entry *taken = find_entry(scope, name);
  if (taken != NULL && taken->line > 0) {
    report_error(scope->diagnostics, line, "the name '%s' is already defined on line %ld; expected another name", name,
                 taken->line);
    return false;
  }
  if (taken != NULL) {
    report_error(scope->diagnostics, line, "the name '%s' belongs to the language itself; expected another name", name);
    return false;
  }
  add_entry(scope, name, quantity, line);
  return true;
}

void scope_set_number(struct Scope *scope, const char *name, double value) {
  struct Quantity number = {.node = graph_constant(scope->graph, value), .dimension = dimension_one, .literal = true};
  add_entry(scope, name, number, 0);
}

void scope_remove(struct Scope *scope, const char *name) {
  names_remove(scope->names, name);
}

const struct Quantity *scope_find(const struct Scope *scope, const char *name) {
  const struct Entry *entry = find_entry(scope, name);
  return entry == NULL ? NULL : &entry->quantity;
}

enum { NAME_LIMIT = 40 };

/* Levenshtein's distance; names of NAME_LIMIT letters and more are never similar. */
static size_t edit_distance(const char *a, const char *b) {
  size_t n = strlen(b), row[NAME_LIMIT + 1];
  if (n >= NAME_LIMIT || strlen(a) >= NAME_LIMIT) return NAME_LIMIT;
  for (size_t j = 0; j <= n; j++) row[j] = j;
  for (size_t i = 1; a[i - 1] != '\0'; i++) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= n; j++) {
      size_t best = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      if (row[j] + 1 < best) best = row[j] + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      row[j] = best;
    }
  }
  return row[n];
}

/* The nearest name, and of several the first in the alphabet. */
const char *scope_similar_name(const struct Scope *scope, const char *name) {
  size_t least = strlen(name) > 3 ? 3 : 2;
  const char *best = NULL;
  for (size_t i = 0; i < scope->names->capacity; i++) {
    const char *known = scope->names->places[i].text;
    if (known == NULL) continue;
    size_t distance = edit_distance(name, known);
    bool earlier = best != NULL && distance == least && strcmp(known, best) < 0;
    if (distance > least || (distance == least && !earlier)) continue;
    least = distance;
    best = known;
  }
  return best;
}

bool scope_units_agree(const struct Scope *scope, struct Dimension first, struct Dimension second) {
  return !scope->checks_units || dimension_agrees(first, second);
}

Node scope_symbol(struct Scope *scope, enum SymbolKind kind, int index, const char *name, struct Dimension dimension,
                  long line) {
  Node node = graph_symbol(scope->graph, kind, index, name);
  scope->time_derivatives =
      reallocate(scope->time_derivatives, scope->graph->symbol_count, sizeof *scope->time_derivatives);
  scope->time_derivatives[scope->graph->symbol_count - 1] = ZERO;
  if (kind <= INPUT && kind != ACCELERATION)
    scope_define(scope, name, (struct Quantity){.node = node, .dimension = dimension}, line);
  return node;
}

void scope_set_time_derivative(struct Scope *scope, Node symbol, Node derivative) {
  scope->time_derivatives[scope->graph->vertices[symbol].left] = derivative;
}

Node total_time_derivative(struct Scope *scope, Node node) {
  Node derivative;
  derivative_along(scope->graph, &node, 1, scope->time_derivatives, &derivative);
  return derivative;
}
