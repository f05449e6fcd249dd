#include "mechanics/arrays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

/* The length of the name before [index] at its end, or before [index]) of a derivative; 0 where it does not end so. */
static size_t length_before_index(const char *name, size_t index) {
  char *ends[] = {format_text("[%zu]", index), format_text("[%zu])", index)};
  size_t length = strlen(name), found = 0;
  for (int i = 0; i < 2; i++) {
    size_t end = strlen(ends[i]);
    bool is_derivative = strncmp(name, "der(", 4) == 0;
    if (is_derivative == (i == 1) && length > end && strcmp(name + length - end, ends[i]) == 0) found = length - end;
    free(ends[i]);
  }
  return found;
}

static bool are_same_text(const char *a, const char *b) {
  return a == b || (a != NULL && b != NULL && strcmp(a, b) == 0);
}

static bool are_same_number(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

/* Whether one declaration can hold for both but for the start. Derivatives are described by their states. */
static bool are_alike(const struct InterfaceVariable *a, const struct InterfaceVariable *b) {
  const struct ScalarVariable *first = &a->entry, *second = &b->entry;
  return first->kind == second->kind && first->type == second->type && first->is_output == second->is_output &&
         (first->follows_from == NULL) == (second->follows_from == NULL) && starts_nearby(a) == starts_nearby(b) &&
         are_same_number(first->minimum, second->minimum) && are_same_number(first->maximum, second->maximum) &&
         are_same_number(a->nominal, b->nominal) && are_same_text(a->unit, b->unit) &&
         (first->kind == VARIABLE_DERIVATIVE || are_same_text(a->description, b->description));
}

static bool has_variable(const struct Interface *interface, const char *name) {
  for (size_t i = 0; i < interface->count; i++)
    if (strcmp(interface->variables[i].entry.name, name) == 0) return true;
  return false;
}

/* Whether there is an element of this index, wherever it stands. */
static bool has_element(const struct Interface *interface, const char *first, size_t length, size_t index) {
  char *name = format_text("%.*s[%zu]%s", (int)length, first, index, strncmp(first, "der(", 4) == 0 ? ")" : "");
  bool has = has_variable(interface, name);
  free(name);
  return has;
}

/* How many elements of one array begin with the variable; 0 where it begins none. */
static size_t count_elements(const struct Interface *interface, size_t first) {
  const struct InterfaceVariable *variables = interface->variables;
  const char *name = variables[first].entry.name;
  size_t length = length_before_index(name, 1), count = 0;
  for (; length > 0 && first + count < interface->count; count++) {
    const char *next = variables[first + count].entry.name;
    if (length_before_index(next, count + 1) != length || strncmp(name, next, length) != 0) break;
    if (!are_alike(&variables[first], &variables[first + count])) return 0;
  }
  return count > 0 && has_element(interface, name, length, count + 1) ? 0 : count;
}

/* Whether a variable of the same index is of an array of so many elements. */
static bool begins_array(const struct Interface *interface, enum VariableKind kind, size_t index, size_t count) {
  return interface->variables[interface_find(interface, kind, index)].array_count == count;
}

void arrays_find(struct Interface *interface) {
  for (size_t i = 0; i < interface->count; i++) {
    struct InterfaceVariable *variable = &interface->variables[i];
    if (variable->is_further_element) continue;
    size_t count = count_elements(interface, i);
    /* An array of states has one of derivatives, and the other way round. */
    if (variable->entry.kind == VARIABLE_DERIVATIVE && count > 0 &&
        !begins_array(interface, VARIABLE_STATE, variable->entry.index, count))
      continue;
    variable->array_count = count;
    char *name = array_name(variable);
    if (count > 0 && has_variable(interface, name)) variable->array_count = 0;
    free(name);
    for (size_t j = 1; j < variable->array_count; j++) variable[j].is_further_element = true;
  }
}

char *array_name(const struct InterfaceVariable *variable) {
  const char *name = variable->entry.name;
  if (variable->array_count == 0) return copy_text(name);
  bool is_derivative = variable->entry.kind == VARIABLE_DERIVATIVE;
  return format_text("%.*s%s", (int)length_before_index(name, 1), name, is_derivative ? ")" : "");
}
