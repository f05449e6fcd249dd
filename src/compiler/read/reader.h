/* Reads system.xml into a model. */
#pragma once

#include "base/diagnostics.h"
#include "model/model.h"
#include "read/context/reader_options.h"

/*
 * Reads a system, or the system that a <linearization> names together with its point. Every error is reported;
 * returns NULL where there was any.
 */
struct Model *model_read(const char *path, const struct ReaderOptions *options, struct Diagnostics *diagnostics);
