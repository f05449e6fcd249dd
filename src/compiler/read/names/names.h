/* A table of names: what each stands for is found in a time that does not grow with their number. */
#pragma once

#include <stddef.h>

struct Name {
  char *text; /* NULL where the place is empty */
  void *meaning;
};

struct Names {
  struct Name *places;
  size_t capacity, count;
};

struct Names *names_create(void);

/* What the name stands for; NULL where it is not in the table. */
void *names_find(const struct Names *names, const char *text);

/* Gives a name a meaning, in place of the one before, which is given back. */
void names_set(struct Names *names, const char *text, void *meaning);

/* Does nothing where the name is not in the table. */
void names_remove(struct Names *names, const char *text);
