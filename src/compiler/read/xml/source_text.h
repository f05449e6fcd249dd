/* The text of an XML file, as far as it is not so large or so made that reading it would take long. */
#pragma once

#include <stddef.h>

#include "base/diagnostics.h"

/*
 * The bytes of the file. NULL where it cannot be read, and after reporting that it is too long, or
 * has too many elements, or attributes in one of them.
 */
char *source_text(const char *path, size_t *length, struct Diagnostics *diagnostics);
