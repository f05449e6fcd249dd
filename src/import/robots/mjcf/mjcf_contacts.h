/* Contacts of geoms with the ground, and their friction, by MuJoCo's rules; warnings of other contacts. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Reads a <pair> or <exclude>; called before geoms are read. */
void mjcf_read_rule(struct Mjcf *mjcf, xmlNodePtr node);

/* Returns the contact attributes of a geom. */
struct MjcfContact mjcf_contact(struct Mjcf *mjcf, xmlNodePtr node);

/* True if the geom can touch any other one, by its masks or a <pair>. */
bool mjcf_may_collide(const struct Mjcf *mjcf, const struct MjcfContact *contact);

/* Records the geom and sets its friction on the ground; called after the geoms of the <worldbody> are read. */
void mjcf_set_contact(struct Mjcf *mjcf, const struct MjcfContact *contact, struct Collision *shape);

/* Warns of contacts that exist in MuJoCo only, once all geoms are read. */
void mjcf_check_contacts(struct Mjcf *mjcf);
