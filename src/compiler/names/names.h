/* A hash table from names to values. Finding, setting and removing a name take constant time on average. */
#pragma once

#include <stddef.h>

/* A slot of the table. */
struct Name {
  char *text; /* NULL in an empty slot */
  void *meaning;
};

/* The table. capacity is a power of two, and at least half of the slots are empty. */
struct Names {
  struct Name *slots;
  size_t capacity, count;
};

/* Returns an empty table. */
struct Names *names_create(void);

/* Returns the value of a name; NULL if it is not in the table. */
void *names_find(const struct Names *names, const char *text);

/* Sets the value of a name, of which the table takes ownership, and releases the old one. */
void names_set(struct Names *names, const char *text, void *meaning);

/* Removes a name and releases its value; does nothing if it is not in the table. */
void names_remove(struct Names *names, const char *text);
