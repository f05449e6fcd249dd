/* Names of elements in MJCF, and the attributes that refer to them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

#include "names/names.h"

/* An attribute that refers to an element of this kind. */
struct MjcfReference {
  const char *attribute, *kind;
};

enum { MJCF_REFERENCES = 20 };

extern const struct MjcfReference mjcf_references[MJCF_REFERENCES];

/* Sections whose elements refer to others, those first to which others of them refer. */
enum { MJCF_REFERRING_SECTIONS = 4 };

extern const char *const mjcf_referring_sections[MJCF_REFERRING_SECTIONS];

/* Adds the name of an element with its kind; mjcf_note_names(): of all its descendants. */
void mjcf_note_name(struct Names *names, xmlNodePtr node);
void mjcf_note_names(struct Names *names, xmlNodePtr parent);

/* True if an element refers by this attribute to one of the names. */
bool mjcf_refers(const struct Names *names, xmlNodePtr node, size_t reference);

/* Returns the number of references to these names in an element and its descendants; to any names for NULL. */
size_t mjcf_count_references(const struct Names *names, xmlNodePtr node);

/* Returns the name that MuJoCo gives to the asset of a file: that of the file, without folders and ending. */
char *mjcf_asset_name(const char *file);
