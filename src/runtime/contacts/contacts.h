/* What contacts.c and contact_forces.c share. */
#ifndef CONTACTS_H
#define CONTACTS_H

#include "events/settlement.h"

/* Whether the gap is 0, but for rounding. */
bool is_touching(const struct Settlement *settlement, size_t contact);

#endif
