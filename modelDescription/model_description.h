/* Writes modelDescription.xml (FMI 2.0.4, sections 2.2, 3.3 and 4.3). */
#pragma once

#include <libxml/tree.h>

#include "program/program.h"

/* Appends the file to buffer. Returns false if libxml2 reports an error. */
bool model_description_write(xmlBufferPtr buffer, const struct Program *program, const char *guid);
