#include "names/scope.h"

#include <math.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "base/memory.h"
#include "names/similar.h"

/* The meaning of a name. */
struct ScopeEntry {
  struct Quantity quantity;
  long line; /* of the definition; 0 for words of the language, compile-time numbers and indices */
  bool is_index;
};

struct Scope *scope_create(struct Graph *graph, struct Diagnostics *diagnostics) {
  struct Scope *scope = allocate(1, sizeof *scope);
  scope->graph = graph;
  scope->diagnostics = diagnostics;
  scope->names = names_create();
  scope->tables = names_create();
  scope->functions = names_create();
  scope->warned_numbers = names_create();
  scope->noted_integrals = names_create();
  scope->prefix = "";
  scope->relevance = ONE;
  return scope;
}

static struct ScopeEntry *find_entry(const struct Scope *scope, const char *name) {
  return names_find(scope->names, name);
}

static void add_entry(struct Scope *scope, const char *name, struct Quantity quantity, long line) {
  struct ScopeEntry *entry = allocate(1, sizeof *entry);
  *entry = (struct ScopeEntry){.quantity = quantity, .line = line};
  names_set(scope->names, name, entry);
}

bool scope_define(struct Scope *scope, const char *name, struct Quantity quantity, long line) {
  const struct ScopeEntry *taken = find_entry(scope, name);
  if (taken != NULL && taken->line != 0) {
    report_error(scope->diagnostics, line, "the name '%s' is already defined on line %ld; expected another name%s",
                 name, file_line(scope->diagnostics, taken->line).line,
                 taken->line == line ? ", or an index such as [i] where a <for> repeats it" : "");
    return false;
  }
  if (taken != NULL) {
    report_error(scope->diagnostics, line, "the name '%s' %s; expected another name", name,
                 taken->is_index ? "is the index of a <for> around it" : "belongs to the language itself");
    return false;
  }
  add_entry(scope, name, quantity, line);
  return true;
}

void scope_set_dimension(struct Scope *scope, const char *name, struct Dimension dimension) {
  find_entry(scope, name)->quantity.dimension = dimension;
}

void scope_set_number(struct Scope *scope, const char *name, double value) {
  struct Quantity number = {.node = graph_constant(scope->graph, value), .dimension = dimension_one, .literal = true};
  add_entry(scope, name, number, 0);
}

void scope_set_index(struct Scope *scope, const char *name, double value) {
  scope_set_number(scope, name, value);
  find_entry(scope, name)->is_index = true;
}

/* Does nothing if the name is not an index. */
void scope_remove_index(struct Scope *scope, const char *name) {
  const struct ScopeEntry *entry = find_entry(scope, name);
  if (entry != NULL && entry->is_index) names_remove(scope->names, name);
}

bool scope_is_index(const struct Scope *scope, const char *name) {
  const struct ScopeEntry *entry = find_entry(scope, name);
  return entry != NULL && entry->is_index;
}

void scope_remove(struct Scope *scope, const char *name) {
  names_remove(scope->names, name);
}

const struct Quantity *scope_find(const struct Scope *scope, const char *name) {
  const struct ScopeEntry *entry = find_entry(scope, name);
  return entry == NULL ? NULL : &entry->quantity;
}

static bool is_of_language(const struct ScopeEntry *entry) {
  return entry != NULL && entry->line == 0 && !entry->is_index;
}

char *scope_full_name(const struct Scope *scope, const char *name) {
  bool as_it_is = *scope->prefix == '\0' || is_of_language(find_entry(scope, name));
  return format_text("%s%s", as_it_is ? "" : scope->prefix, name);
}

long scope_line(const struct Scope *scope, long line) {
  return note_line(scope->diagnostics, line);
}

bool scope_is_reserved(const struct Scope *scope, const struct Quantity *quantity) {
  return graph_is_constant(scope->graph, quantity->node) && isnan(graph_value(scope->graph, quantity->node));
}

const char *scope_similar_name(const struct Scope *scope, const char *name) {
  struct SimilarName similar = {.wanted = name};
  size_t length = strlen(scope->prefix);
  for (size_t i = 0; i < scope->names->capacity; i++) {
    const char *known = scope->names->slots[i].text;
    if (known == NULL || scope_is_reserved(scope, scope_find(scope, known))) continue;
    if (strncmp(known, scope->prefix, length) == 0) similar_consider(&similar, known + length);
  }
  return similar.best;
}

bool scope_units_agree(const struct Scope *scope, struct Dimension first, struct Dimension second) {
  return !scope->checks_units || dimension_agrees(first, second);
}

/* Extends the list to symbols added since, such as modes, which are constant unless set otherwise. */
static Node *time_derivatives_of(struct Scope *scope) {
  size_t count = scope->graph->symbol_count;
  for (; scope->time_derivative_count < count; scope->time_derivative_count++) {
    scope->time_derivatives =
        make_room(scope->time_derivatives, scope->time_derivative_count, sizeof *scope->time_derivatives);
    scope->time_derivatives[scope->time_derivative_count] = ZERO;
  }
  return scope->time_derivatives;
}

Node scope_symbol(struct Scope *scope, enum SymbolKind kind, int index, const char *name, struct Dimension dimension,
                  long line) {
  Node node = graph_symbol(scope->graph, kind, index, name);
  if (kind < SEED_PARAMETER && kind != ACCELERATION)
    scope_define(scope, name, (struct Quantity){.node = node, .dimension = dimension}, line);
  return node;
}

void scope_set_time_derivative(struct Scope *scope, Node symbol, Node derivative) {
  time_derivatives_of(scope)[scope->graph->vertices[symbol].left] = derivative;
}

Node time_derivative_of_symbol(const struct Scope *scope, Node symbol) {
  size_t number = scope->graph->vertices[symbol].left;
  return number < scope->time_derivative_count ? scope->time_derivatives[number] : ZERO;
}

Node total_time_derivative(struct Scope *scope, Node node) {
  Node derivative = ZERO;
  derivatives_find(scope->graph, &node, 1, time_derivatives_of(scope), &scope->rates, &derivative);
  return derivative;
}
