/* What the programs share that time an FMU. Functions return 0 where the FMU gives up. */
#ifndef MEASURING_H
#define MEASURING_H

#include "fmu_library.h"

/* Of the processor, which other work on the machine hardly lengthens. */
double seconds(void);

/* Resets the FMU and leaves its initialization mode; starts: REFERENCE=VALUE. */
int initialize(const struct FmuLibrary *fmu, fmi2Component c, double tolerance, int count, char **starts);

/* A line with the Real variables whose references are listed, with commas between them. */
int print_outputs(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

/* The same for Integer variables. */
int print_counts(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

#endif
