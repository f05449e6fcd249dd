/*
 * <include>: other files as parts of a system. Their names get a prefix: theta of motor.xml is motor.theta in the
 * system. An <include> may override values of elements in the file.
 */
#pragma once

#include "read/context/attributes.h"

/* A file of the system: the main one, or an included one, once per <include> and repetition. */
struct Source {
  const char *file;     /* name for messages */
  char *canonical_path; /* equal for all names of the same file */
  char *prefix;         /* of its names: "motor."; "" for the main file */
  char *origin;         /* how the file is included, for messages; NULL for the main file */
  xmlNodePtr include;   /* the <include> element; NULL for the main file */
  xmlNodePtr root;      /* <system>; NULL if the file cannot be read */
  struct Source *outer; /* the file that contains the <include>; NULL for the main file */
  size_t body_count;    /* bodies declared so far */
};

/* An override of a declaration by an <include>, in a list that begins with the outermost <include>. */
struct Override {
  xmlNodePtr node;             /* the overriding element in the <include> */
  struct Source *source;       /* of the overriding element */
  const struct Source *target; /* the included file with the declaration */
  struct Override *inner;      /* override by the next inner <include>; NULL for none */
  bool is_used;
};

/* Begin and end with the main file, which becomes the reader's source. includes_end() frees all documents. */
void includes_begin(struct Reader *reader, const char *path, xmlNodePtr root);
void includes_end(struct Reader *reader);

/* Returns the source for an <include> element; NULL after reporting an error. */
struct Source *include_open(struct Reader *reader, xmlNodePtr node);

/* Makes another file current; returns the previous one. */
struct Source *source_enter(struct Reader *reader, struct Source *source);

/* Returns the path of a file that the current file names. The name is relative to the current file. */
char *path_beside(const struct Reader *reader, const char *file);

/* Returns the overrides of the element of this full name; NULL for none. Reports those by other elements. */
const struct Override *overrides_of(struct Reader *reader, xmlNodePtr node, const char *name);

/* Returns the outermost override with this attribute; NULL for none. */
const struct Override *override_of_attribute(const struct Override *overrides, const char *attribute);

/* Returns the outermost override with a value, unless one further out has a start; NULL for none. */
const struct Override *override_of_value(const struct Override *overrides);

/* Enters the file of an override, unless NULL, and sets the node to its element. Returns the previous file. */
struct Source *enter_override(struct Reader *reader, const struct Override *override, xmlNodePtr *node);

/* Like number_attribute(), for the outermost override with the attribute, else for the node itself. */
bool overridden_number_attribute(struct Reader *reader, xmlNodePtr node, const struct Override *overrides,
                                 const char *name, double *value);

/* Reports overrides of elements that do not exist. */
void check_overrides(struct Reader *reader);
