/* Writes documentation/licenses/license.txt, the entry point to an FMU's licences (FMI 3.0, section 2.5.1). */
#ifndef LICENSES_H
#define LICENSES_H

#include <stdio.h>

#include "program/program.h"

/* Writes the licence of the FMU, and the names of the files with the licences of linked libraries. */
void licenses_write(FILE *file, const struct Program *program);

#endif
