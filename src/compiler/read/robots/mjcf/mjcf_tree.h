/* The links and joints that elements of MJCF become, and where they are. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* The name of the link that the <worldbody> is. */
extern const char mjcf_world[];

struct Link *mjcf_add_link(struct Mjcf *mjcf, xmlNodePtr node, char *name);

/* Along z, without limits and losses. */
struct Joint *mjcf_add_joint(struct Mjcf *mjcf, xmlNodePtr node, enum JointType type, char *name, char *parent,
                             char *child);

/* NULL for none of this name. */
struct Joint *mjcf_joint(const struct Mjcf *mjcf, const char *name);

/* A link that does not move in its parent. */
void mjcf_fix(struct Mjcf *mjcf, xmlNodePtr node, char *parent, char *child, const struct Placement *place);

/* Notes where a body or site is while all joints are at their ref, by its place in its parent, which is NULL for the world. */
void mjcf_note_place(struct Mjcf *mjcf, const char *name, const char *parent, const struct Placement *place);

/* The same in the world; NULL where there is no such body or site. */
const struct Placement *mjcf_place_of(const struct Mjcf *mjcf, const char *name);
