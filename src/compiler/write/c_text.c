#include "write/c_text.h"

#include <math.h>
#include <string.h>

#include "algebra/formula.h"

#define VALUES(c_type, value_type)                                                                                     \
  { c_type, sizeof(value_type), &(const struct Field){.type = TYPE_OF_VALUE((value_type){0})}, 1 }
const struct ElementType size_elements = VALUES("size_t", size_t), int_elements = VALUES("int", int),
                         truth_elements = VALUES("bool", bool), number_elements = VALUES("double", double),
                         text_elements = VALUES("char *const", const char *);

void write_c_number(FILE *file, double value) {
  if (isnan(value)) fputs("NAN", file);
  else if (isinf(value)) fputs(value > 0 ? "INFINITY" : "-INFINITY", file);
  else {
    print_number(file, value);
    if (value == floor(value) && fabs(value) < 1e15) fputs(".0", file);
  }
}

void write_c_string(FILE *file, const char *text) {
  fputc('"', file);
  for (; *text != '\0'; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', file);
    fputc(*text, file);
  }
  fputc('"', file);
}

static void write_text(FILE *file, const char *text) {
  if (text != NULL) write_c_string(file, text);
  else fputs("NULL", file);
}

static void write_value(FILE *file, const struct Field *field, const void *at) {
  switch (field->type) {
  case VALUE_SIZE: fprintf(file, "%zu", *(const size_t *)at); return;
  case VALUE_INT: fprintf(file, "%d", *(const int *)at); return;
  case VALUE_LONG: fprintf(file, "%ld", *(const long *)at); return;
  case VALUE_TRUTH: fputs(*(const bool *)at ? "true" : "false", file); return;
  case VALUE_NUMBER: write_c_number(file, *(const double *)at); return;
  case VALUE_TEXT: write_text(file, *(const char *const *)at); return;
  case VALUE_PAIR: fprintf(file, "{%zu, %zu}", ((const size_t *)at)[0], ((const size_t *)at)[1]); return;
  case VALUE_NAME: fputs(field->names[*(const int *)at], file); return;
  case VALUE_ARRAY: fputs(field->array, file); return;
  }
}

static void write_element(FILE *file, const struct ElementType *elements, const char *element) {
  bool is_struct = elements->fields[0].name != NULL;
  for (size_t i = 0; i < elements->field_count; i++) {
    fputs(i > 0 ? ", " : is_struct ? "{" : "", file);
    write_value(file, &elements->fields[i], element + elements->fields[i].offset);
  }
  fputs(is_struct ? "}" : "", file);
}

void write_array(FILE *file, const char *name, const struct ElementType *elements, const void *items, size_t count) {
  bool has_lines = elements->fields[0].name != NULL || elements->fields[0].type == VALUE_TEXT;
  fprintf(file, "static const %s %s[] = {", elements->type, name);
  for (size_t i = 0; i < count; i++) {
    if (i > 0) fputs(",", file);
    fputs(has_lines || (i > 0 && i % 16 == 0) ? "\n    " : i > 0 ? " " : "", file);
    write_element(file, elements, (const char *)items + i * elements->size);
  }
  fputs(count == 0 ? "0};\n" : "};\n", file);
}

void write_sizes(FILE *file, const char *type, const char *name, const size_t *sizes, size_t count) {
  struct ElementType elements = size_elements;
  elements.type = type;
  write_array(file, name, &elements, sizes, count);
}

/* Returns the length of the array that a field points to; 0 without one. */
static size_t length_of(const struct Field *field, const char *content) {
  const void *const *array = (const void *)(content + field->offset);
  return *array != NULL ? *(const size_t *)(const void *)(content + field->count) : 0;
}

static bool is_empty(const struct Field *field, const char *content) {
  static const char zeros[sizeof(double)] = {0};
  return field->type == VALUE_ARRAY ? length_of(field, content) == 0
                                    : memcmp(content + field->offset, zeros, field->size) == 0;
}

void write_arrays(FILE *file, const struct ElementType *type, const void *content) {
  for (const struct Field *field = type->fields; field < type->fields + type->field_count; field++) {
    if (field->type != VALUE_ARRAY || is_empty(field, content)) continue;
    const void *const *array = (const void *)((const char *)content + field->offset);
    write_array(file, field->array, field->elements, *array, length_of(field, content));
    fputs("\n", file);
  }
}

void write_fields(FILE *file, const struct ElementType *type, const void *content) {
  for (const struct Field *field = type->fields; field < type->fields + type->field_count; field++) {
    if (is_empty(field, content)) continue;
    fprintf(file, "    .%s = ", field->name);
    write_value(file, field, (const char *)content + field->offset);
    fputs(",\n", file);
  }
}
