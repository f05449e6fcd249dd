/* Writes numbers, strings, arrays and the fields of structs as C constants. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The types of values. The value of an enum is written as its name, and a NULL text as NULL. */
enum ValueType {
  VALUE_SIZE,
  VALUE_INT,
  VALUE_LONG,
  VALUE_TRUTH,
  VALUE_NUMBER,
  VALUE_TEXT,
  VALUE_PAIR, /* of sizes */
  VALUE_NAME,
  VALUE_ARRAY /* a pointer to one */
};

/* A field of a struct. Its `names` are for VALUE_NAME, what follows them for VALUE_ARRAY; its `size` for others. */
struct Field {
  const char *name; /* as in an initializer, such as steps.tolerance */
  size_t offset, size;
  enum ValueType type;
  const char *const *names; /* of the enum's values */
  const struct ElementType *elements;
  const char *array; /* name of the definition */
  size_t count;      /* offset of the field with the length, a size_t */
};

/* A struct, or, if fields[0] has no name, a value of its type. */
struct ElementType {
  const char *type; /* in C */
  size_t size;
  const struct Field *fields;
  size_t field_count;
};

#define TYPE_OF_VALUE(value)                                                                                           \
  _Generic((value),                                                                                                    \
      size_t: VALUE_SIZE,                                                                                              \
      int: VALUE_INT,                                                                                                  \
      long: VALUE_LONG,                                                                                                \
      bool: VALUE_TRUTH,                                                                                               \
      double: VALUE_NUMBER,                                                                                            \
      const char *: VALUE_TEXT,                                                                                        \
      size_t *: VALUE_PAIR)

/*
 * Initialize a struct Field: a value, the value of an enum with these names, and an array. STRUCT_TYPE initializes a
 * struct ElementType by a list of them.
 */
#define MEMBER(table, member) .name = #member, .offset = offsetof(struct table, member)
#define FIELD(table, member)                                                                                           \
  {                                                                                                                    \
    MEMBER(table, member), .size = sizeof(((struct table *)0)->member),                                                \
                           .type = TYPE_OF_VALUE(((struct table *)0)->member)                                          \
  }
#define NAMED_FIELD(table, member, texts)                                                                              \
  { MEMBER(table, member), .type = VALUE_NAME, .names = (texts) }
#define ARRAY_FIELD(table, member, length, definition, content)                                                        \
  {                                                                                                                    \
    MEMBER(table, member), .type = VALUE_ARRAY, .elements = &(content), .array = (definition),                         \
                           .count = offsetof(struct table, length)                                                     \
  }
#define STRUCT_TYPE(element, ...)                                                                                      \
  {                                                                                                                    \
    "struct " #element, sizeof(struct element), (const struct Field[]){__VA_ARGS__},                                   \
        sizeof((const struct Field[]){__VA_ARGS__}) / sizeof(struct Field)                                             \
  }

/* Plain values. */
extern const struct ElementType size_elements, int_elements, truth_elements, number_elements, text_elements;

/* Writes a number with as many digits as distinguish it from all others. */
void write_c_number(FILE *file, double value);

/* Writes a string literal. */
void write_c_string(FILE *file, const char *text);

/* Writes the definition of a static array; an empty one gets an element 0, as C requires. */
void write_array(FILE *file, const char *name, const struct ElementType *elements, const void *items, size_t count);

/* Does the same for sizes, as elements of this type. */
void write_sizes(FILE *file, const char *type, const char *name, const size_t *sizes, size_t count);

/* Writes the definitions of the arrays that the fields of a struct point to, without those that are empty. */
void write_arrays(FILE *file, const struct ElementType *type, const void *content);

/* Writes initializers of the fields of a struct, without those that are 0 or empty. */
void write_fields(FILE *file, const struct ElementType *type, const void *content);
