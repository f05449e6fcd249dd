/* documentation/licenses/license.txt, where readers of an FMU's licences begin (FMI 3.0, section 2.5.1). */
#ifndef LICENSES_H
#define LICENSES_H

#include <stdio.h>

#include "program/program.h"

/* The licence of what is in the FMU, and the names of the files beside it that have those of libraries in it. */
void licenses_write(FILE *file, const struct Program *program);

#endif
