#include "interface/arrays.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Returns the text without any "[index]". */
static char *without_index(const char *text, size_t index) {
  char *subscript = format_text("[%zu]", index), *copy = copy_text(text), *found = copy;
  size_t length = strlen(subscript);
  while ((found = strstr(found, subscript)) != NULL) memmove(found, found + length, strlen(found + length) + 1);
  return copy;
}

/* True if the name ends with "[index]", or is the derivative of such a name. */
static bool is_element(const char *name, size_t index) {
  char *end = format_text(strncmp(name, "der(", 4) == 0 ? "[%zu])" : "[%zu]", index);
  size_t length = strlen(name), end_length = strlen(end);
  return length > end_length && strcmp(name + length - end_length, end) == 0;
}

/* True if the texts are equal apart from their own indices. */
static bool are_same_text(const char *a, size_t index_of_a, const char *b, size_t index_of_b) {
  if (a == NULL || b == NULL) return a == b;
  char *first = without_index(a, index_of_a), *second = without_index(b, index_of_b);
  return strcmp(first, second) == 0;
}

static bool are_same_number(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

/* True if one declaration can hold for element 1 and this element, apart from the start value. */
static bool are_alike(const struct InterfaceVariable *a, const struct InterfaceVariable *b, size_t index) {
  const struct ScalarVariable *first = &a->entry, *second = &b->entry;
  return first->kind == second->kind && first->type == second->type && first->is_output == second->is_output &&
         first->is_reinitialized == second->is_reinitialized &&
         (first->follows_from == NULL) == (second->follows_from == NULL) && starts_nearby(a) == starts_nearby(b) &&
         are_same_number(first->minimum, second->minimum) && are_same_number(first->maximum, second->maximum) &&
         are_same_number(a->nominal, b->nominal) && are_same_text(a->unit, 1, b->unit, index) &&
         are_same_text(a->display_unit, 1, b->display_unit, index) &&
         are_same_text(a->description, 1, b->description, index);
}

static bool has_variable(const struct Interface *interface, const char *name) {
  for (size_t i = 0; i < interface->count; i++)
    if (strcmp(interface->variables[i].entry.name, name) == 0) return true;
  return false;
}

/* True if the interface has an element of this index of the array of `first`, anywhere. */
static bool has_element(const struct Interface *interface, const char *first, size_t index) {
  for (size_t i = 0; i < interface->count; i++) {
    const char *name = interface->variables[i].entry.name;
    if (is_element(name, index) && are_same_text(first, 1, name, index)) return true;
  }
  return false;
}

/*
 * Returns the number of elements of the array that begins with the variable; 0 for none. Event indicators stay scalars,
 * as importers expect.
 */
static size_t count_elements(const struct Interface *interface, size_t found) {
  const struct InterfaceVariable *first = &interface->variables[found];
  const char *name = first->entry.name;
  size_t count = 0;
  if (first->entry.kind == VARIABLE_INDICATOR || !is_element(name, 1)) return 0;
  for (; found + count < interface->count; count++) {
    const char *next = first[count].entry.name;
    if (!is_element(next, count + 1) || !are_same_text(name, 1, next, count + 1)) break;
    if (!are_alike(first, &first[count], count + 1)) return 0;
  }
  return has_element(interface, name, count + 1) ? 0 : count;
}

/* True if the variable of this kind and index begins an array of count elements. */
static bool begins_array(const struct Interface *interface, enum VariableKind kind, size_t index, size_t count) {
  return interface->variables[interface_find(interface, kind, index)].array_count == count;
}

void arrays_find(struct Interface *interface) {
  for (size_t i = 0; i < interface->count; i++) {
    struct InterfaceVariable *variable = &interface->variables[i];
    if (variable->is_further_element) continue;
    size_t count = count_elements(interface, i);
    /* An array of derivatives needs an array of states. */
    if (variable->entry.kind == VARIABLE_DERIVATIVE && count > 0 &&
        !begins_array(interface, VARIABLE_STATE, variable->entry.index, count))
      continue;
    variable->array_count = count;
    if (count > 0 && has_variable(interface, array_name(variable))) variable->array_count = 0;
    for (size_t j = 1; j < variable->array_count; j++) variable[j].is_further_element = true;
  }
}

char *array_name(const struct InterfaceVariable *variable) {
  return variable->array_count == 0 ? copy_text(variable->entry.name) : without_index(variable->entry.name, 1);
}

char *array_description(const struct InterfaceVariable *variable) {
  if (variable->description == NULL) return NULL;
  return variable->array_count == 0 ? copy_text(variable->description) : without_index(variable->description, 1);
}
