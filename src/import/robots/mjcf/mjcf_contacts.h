/* Contacts of geoms with the ground and with each other, and their friction, by MuJoCo's rules. */
#pragma once

#include "robots/mjcf/values/mjcf_values.h"

/* Reads a <pair> or <exclude>; called before geoms are read. */
void mjcf_read_rule(struct Mjcf *mjcf, xmlNodePtr node);

/* Returns the contact attributes of a geom. */
struct MjcfContact mjcf_contact(struct Mjcf *mjcf, xmlNodePtr node);

/* True if the geom can touch any other one, by its masks or a <pair>. */
bool mjcf_may_collide(const struct Mjcf *mjcf, const struct MjcfContact *contact);

/* True if the geom's body does not move. */
bool mjcf_is_static(const struct MjcfContact *contact);

/* Records the geom, which becomes the next collision of the link. */
void mjcf_note_contact(struct Mjcf *mjcf, const struct MjcfContact *contact, struct RobotLink *link);

/*
 * Sets which geoms touch the ground, and with which friction. Adds contacts between geoms, if the options request them,
 * and warns of others that exist in MuJoCo only.
 */
void mjcf_find_contacts(struct Mjcf *mjcf);
