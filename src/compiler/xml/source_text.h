/* Reads the text of an XML file and rejects files whose processing would take too long. */
#pragma once

#include <stddef.h>

#include "base/diagnostics.h"

/*
 * Returns the bytes of the file and sets their number; the caller releases them. Returns NULL without a message if the
 * file cannot be read. Returns NULL with a message if it is too long, has too many elements, or too many attributes in
 * one.
 */
char *source_text(const char *path, size_t *length, struct Diagnostics *diagnostics);
