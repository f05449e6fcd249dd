/* The stages of reading a whole system, which reader.c calls in order. */
#pragma once

#include "read/context/attributes.h"

/*
 * Expands <for> and <include>: appends the elements of a <system> to the list, on which all passes work, and declares
 * each one. The order matters: bounds of a <for> may use constants declared before it.
 */
void expand(struct Reader *reader, xmlNodePtr root);

/* Reads all elements of the list in a later pass. */
void read_expanded(struct Reader *reader, enum Pass pass);

/*
 * Adds pointer interaction of a page: the inputs pull.x, ... and pull.of.BODY, which give the position of the pointer
 * and the grabbed point, and spring forces on at most MOST_PULLED bodies, evenly chosen.
 */
void add_pointer_interaction(struct Reader *reader);

/* Reports systems without content, work without forces and the like, and warns of probable mistakes. */
void check_system(struct Reader *reader);

/*
 * Reports a state of first order in positions, energies and constraints whose derivative is missing: it must follow
 * from the state's rate. Called after all elements were read.
 */
void check_moving_states(const struct Reader *reader);

/*
 * Warns of events whose condition has one outcome or whose expression keeps its sign. Also warns if the expression
 * depends only on time and does not cross zero in the event's direction.
 */
void warn_of_events(const struct Reader *reader);

/* Returns the path of the system that a <linearization> names, relative to its file; NULL if it names none. */
char *linearized_path(xmlNodePtr root, const char *path);

/* Turns the model of that system into its linearization, with the name, point and solver in root. */
void read_linearization(struct Model *model, struct Scope *scope, xmlNodePtr root, struct Diagnostics *diagnostics);

/* Sets the point from texts "name=value" and marks the model as linearized. */
void apply_point(struct Model *model, struct Scope *scope, const char *const *point, size_t count,
                 struct Diagnostics *diagnostics);
