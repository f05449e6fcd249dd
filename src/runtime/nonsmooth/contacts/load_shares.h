/* Contacts that touch at rest share the load. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Closes contacts that touch at rest without a force, because others carry the load. Does so at most once an event for
 * each contact. False if there are none.
 */
bool contacts_share_load(struct Resolution *resolution);
