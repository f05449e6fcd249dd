/* Reads system.xml into a model. */
#pragma once

#include "base/diagnostics.h"
#include "model/model.h"
#include "read/context/reader_options.h"

/* Reads a system, or a <linearization> with its system. Reports every error and returns NULL if there was one. */
struct Model *model_read(const char *path, const struct ReaderOptions *options, struct Diagnostics *diagnostics);
