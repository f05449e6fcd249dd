#include "read/names/names.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct Names *names_create(void) {
  struct Names *names = allocate(1, sizeof *names);
  names->capacity = 64; /* a power of two, at least twice the number of names */
  names->places = allocate(names->capacity, sizeof *names->places);
  return names;
}

/* Returns the first slot to search for a name: hash function FNV-1a, linear probing. */
static size_t home_of(const struct Names *names, const char *text) {
  uint64_t hash = 14695981039346656037u;
  for (; *text != '\0'; text++) hash = (hash ^ (unsigned char)*text) * 1099511628211u;
  return (size_t)(hash ^ hash >> 32) & (names->capacity - 1);
}

static size_t after(const struct Names *names, size_t place) {
  return (place + 1) & (names->capacity - 1);
}

/* Returns the slot of a name, or the empty slot for it. */
static struct Name *place_of(const struct Names *names, const char *text) {
  size_t place = home_of(names, text);
  while (names->places[place].text != NULL && strcmp(names->places[place].text, text) != 0) place = after(names, place);
  return &names->places[place];
}

static void grow(struct Names *names) {
  struct Names larger = {.capacity = 2 * names->capacity, .count = names->count};
  larger.places = allocate(larger.capacity, sizeof *larger.places);
  for (size_t i = 0; i < names->capacity; i++)
    if (names->places[i].text != NULL) *place_of(&larger, names->places[i].text) = names->places[i];
  release(names->places);
  *names = larger;
}

void *names_find(const struct Names *names, const char *text) {
  return place_of(names, text)->meaning;
}

void names_set(struct Names *names, const char *text, void *meaning) {
  if (2 * (names->count + 1) > names->capacity) grow(names);
  struct Name *name = place_of(names, text);
  if (name->text == NULL) {
    name->text = copy_text(text);
    names->count++;
  }
  release(name->meaning);
  name->meaning = meaning;
}

void names_remove(struct Names *names, const char *text) {
  struct Name *name = place_of(names, text);
  if (name->text == NULL) return;
  release(name->text);
  release(name->meaning);
  *name = (struct Name){0};
  names->count--;
  /* Names in the following slots may have been displaced by this one: insert them again. */
  size_t place = (size_t)(name - names->places);
  for (place = after(names, place); names->places[place].text != NULL; place = after(names, place)) {
    struct Name moved = names->places[place];
    names->places[place] = (struct Name){0};
    *place_of(names, moved.text) = moved;
  }
}
