#include "names/names.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct Names *names_create(void) {
  struct Names *names = allocate(1, sizeof *names);
  names->capacity = 64; /* a power of two, at least twice the number of names */
  names->slots = allocate(names->capacity, sizeof *names->slots);
  return names;
}

/* Returns the first slot to search for a name: hash function FNV-1a, linear probing. */
static size_t home_of(const struct Names *names, const char *text) {
  uint64_t hash = 14695981039346656037u;
  for (; *text != '\0'; text++) hash = (hash ^ (unsigned char)*text) * 1099511628211u;
  return (size_t)(hash ^ hash >> 32) & (names->capacity - 1);
}

static size_t after(const struct Names *names, size_t slot) {
  return (slot + 1) & (names->capacity - 1);
}

/* Returns the slot of a name, or the empty slot for it. */
static struct Name *slot_for(const struct Names *names, const char *text) {
  size_t slot = home_of(names, text);
  while (names->slots[slot].text != NULL && strcmp(names->slots[slot].text, text) != 0) slot = after(names, slot);
  return &names->slots[slot];
}

static void grow(struct Names *names) {
  struct Names larger = {.capacity = 2 * names->capacity, .count = names->count};
  larger.slots = allocate(larger.capacity, sizeof *larger.slots);
  for (size_t i = 0; i < names->capacity; i++)
    if (names->slots[i].text != NULL) *slot_for(&larger, names->slots[i].text) = names->slots[i];
  release(names->slots);
  *names = larger;
}

void *names_find(const struct Names *names, const char *text) {
  return slot_for(names, text)->meaning;
}

void names_set(struct Names *names, const char *text, void *meaning) {
  if (2 * (names->count + 1) > names->capacity) grow(names);
  struct Name *name = slot_for(names, text);
  if (name->text == NULL) {
    name->text = copy_text(text);
    names->count++;
  }
  release(name->meaning);
  name->meaning = meaning;
}

void names_remove(struct Names *names, const char *text) {
  struct Name *name = slot_for(names, text);
  if (name->text == NULL) return;
  release(name->text);
  release(name->meaning);
  *name = (struct Name){0};
  names->count--;
  /* Names in the following slots may have been displaced by this one: insert them again. */
  size_t slot = (size_t)(name - names->slots);
  for (slot = after(names, slot); names->slots[slot].text != NULL; slot = after(names, slot)) {
    struct Name moved = names->slots[slot];
    names->slots[slot] = (struct Name){0};
    *slot_for(names, moved.text) = moved;
  }
}
