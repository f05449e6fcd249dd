/*
 * <include>: other files that are read as parts of a system, their names with a prefix: what motor.xml calls theta is
 * motor.theta of the system. An <include> may give values to what the file declares.
 */
#pragma once

#include "read/context/attributes.h"

/* A file that is read, each time that it is included. */
struct Source {
  const char *file;     /* as messages name it */
  char *canonical_path; /* the same for two names of one file */
  char *prefix;         /* of its names: "motor."; "" of the system's own file */
  char *origin;         /* for messages; NULL of the system's own file */
  xmlNodePtr include;   /* that asks for it; NULL of the system's own file */
  xmlNodePtr root;      /* <system>; NULL where the file cannot be read */
  struct Source *outer; /* the file with the <include> */
  size_t body_count;    /* of those that were declared */
};

/* What the <include>s around a declaration give to it: a list that begins with the outermost one. */
struct Given {
  xmlNodePtr node;             /* the element in the <include> */
  struct Source *source;       /* in which it stands */
  const struct Source *target; /* the file that it gives to */
  struct Given *inner;         /* of the next <include> further in that gives something; NULL for none */
  bool is_used;
};

/* Begins with the system's own file, which becomes the reader's source. */
void includes_begin(struct Reader *reader, const char *path, xmlNodePtr root);
void includes_end(struct Reader *reader);

/* The source that an <include> asks for; NULL after reporting why there is none. */
struct Source *include_open(struct Reader *reader, xmlNodePtr node);

/* Goes on in another file; returns the one before. */
struct Source *source_enter(struct Reader *reader, struct Source *source);

/* The path of a file that the present one names. */
char *path_beside(const struct Reader *reader, const char *file);

/* What is given to the element of this full name; NULL for nothing. Reports where another kind of element is given. */
const struct Given *given_for(struct Reader *reader, xmlNodePtr node, const char *name);

/* The outermost that gives this attribute; NULL for none. */
const struct Given *giver_of(const struct Given *given, const char *attribute);

/* The outermost that gives a value, if none further out gives a start; NULL for none. */
const struct Given *giver_of_value(const struct Given *given);

/* Enters the file of a giver and sets the node to its element; stays where there is no giver. Returns the file before. */
struct Source *enter_giver(struct Reader *reader, const struct Given *giver, xmlNodePtr *node);

/* As number_attribute(), of the outermost that gives it or else of the node itself. */
bool given_number_attribute(struct Reader *reader, xmlNodePtr node, const struct Given *given, const char *name,
                            double *value);

/* Reports what was given to nothing. */
void check_given(struct Reader *reader);
