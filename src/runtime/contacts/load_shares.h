/* What touches at rest shares the load. */
#ifndef LOAD_SHARES_H
#define LOAD_SHARES_H

#include "events/settlement.h"

/*
 * Closes, once in an event, contacts that touch at rest without a force because others hold them, and press as all share their
 * load; *again where there are any. NULL, or the reason why the motion cannot go on.
 */
const char *contacts_share_load(struct Settlement *settlement, bool *again);

#endif
