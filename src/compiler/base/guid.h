/* A GUID computed from content: the same model has the same GUID on every machine. */
#pragma once

#include <stddef.h>

/* Bytes of a GUID in braces, with the terminating zero. */
enum { GUID_LENGTH = 39 };

/* Writes "{xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx}" for the concatenated texts; count is their number. */
void guid_of(const char *const *texts, size_t count, char guid[GUID_LENGTH]);
