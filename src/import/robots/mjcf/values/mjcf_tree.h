/* Adds links and joints for elements of MJCF, and records their placements. */
#pragma once

#include "robots/mjcf/values/mjcf_values.h"

/* Name of the link of the <worldbody>. */
extern const char mjcf_world[];

/* Adds a link for an element; returns it. */
struct RobotLink *mjcf_add_link(struct Mjcf *mjcf, xmlNodePtr node, char *name);

/* Records the names of all bodies in an element. */
void mjcf_note_bodies(struct Mjcf *mjcf, xmlNodePtr node);

/* Returns the name of the link of a new site: that of the site, or NAME_site if a body has this name. */
char *mjcf_site_link(const struct Mjcf *mjcf, char *name);

/* Returns the name of the link of a site to which an element refers; the name itself if there is none. */
char *mjcf_site(const struct Mjcf *mjcf, char *name);

/* Returns the body of an element: the nearest <body> or <worldbody> outside of <frame>s. */
xmlNodePtr mjcf_body_around(xmlNodePtr node);

bool mjcf_is_joint(xmlNodePtr node);
bool mjcf_has_joint(xmlNodePtr body);

/* True if a <body> moves in the one around it: it has a joint, or a free one by the options. */
bool mjcf_moves(const struct Mjcf *mjcf, xmlNodePtr body);

/* Adds a joint along z, without limits and friction. */
struct RobotJoint *mjcf_add_joint(struct Mjcf *mjcf, xmlNodePtr node, enum RobotJointType type, char *name,
                                  char *parent, char *child);

/* Returns the joint of this name; NULL for none. */
struct RobotJoint *mjcf_joint(const struct Mjcf *mjcf, const char *name);

/* Fixes a link to its parent. */
void mjcf_fix(struct Mjcf *mjcf, xmlNodePtr node, char *parent, char *child, const struct Placement *placement);

/* Records a body's or site's placement in its parent (NULL for the world), with all joints at their ref. */
void mjcf_note_placement(struct Mjcf *mjcf, const char *name, const char *parent, const struct Placement *placement);

/* Returns the placement in the world that was recorded; NULL for none. */
const struct Placement *mjcf_placement_of(const struct Mjcf *mjcf, const char *name);
