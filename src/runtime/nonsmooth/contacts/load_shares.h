/* Contacts that touch at rest share the load. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Closes contacts that touch at rest without a force, because others carry the load, if they press once all share
 * it. Does so at most once per event. Sets *again if there are any. Returns NULL, or the reason why the motion
 * cannot continue.
 */
const char *contacts_share_load(struct Resolution *resolution, bool *again);
