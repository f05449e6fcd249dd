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
  long include_line;    /* of the <include> in the system's own file; 0 of that itself */
  xmlNodePtr include;   /* that asks for it; NULL of the system's own file */
  xmlNodePtr root;      /* <system>; NULL where the file cannot be read */
  struct Source *outer; /* the file with the <include> */
  size_t body_count;    /* of those that were declared */
};

/* What an <include> gives to something that the file declares. */
struct Given {
  xmlNodePtr node;             /* the element in the <include> */
  struct Source *source;       /* in which it stands */
  const struct Source *target; /* the file that it gives to */
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

/* Whether something is given in this attribute. */
bool is_given(const struct Given *given, const char *attribute);

/* As number_attribute(), of what is given or else of the node itself. */
bool given_number_attribute(struct Reader *reader, xmlNodePtr node, const struct Given *given, const char *name,
                            double *value);

/* Reports what was given to nothing. */
void check_given(struct Reader *reader);
