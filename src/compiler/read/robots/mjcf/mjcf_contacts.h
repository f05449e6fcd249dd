/* Which geoms touch the ground, and with which friction, by MuJoCo's rules; and what touches in MuJoCo alone. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* A <pair> or <exclude>, before all geoms. */
void mjcf_read_rule(struct Mjcf *mjcf, xmlNodePtr node);

/* What the element says of its contacts. */
struct MjcfContact mjcf_contact(struct Mjcf *mjcf, xmlNodePtr node);

/* True if the geom touches any other at all, by its masks or a <pair>. */
bool mjcf_touches(const struct Mjcf *mjcf, const struct MjcfContact *contact);

/* Notes the geom for warnings, and finds how it touches the ground: after all geoms of the <worldbody>. */
void mjcf_set_contact(struct Mjcf *mjcf, const struct MjcfContact *contact, struct Collision *shape);

/* Warns of what touches in MuJoCo and not here, once all geoms are read. */
void mjcf_check_contacts(struct Mjcf *mjcf);
