/* What the programs share that time an FMU. Functions return 0 where the FMU gives up. */
#ifndef MEASURING_H
#define MEASURING_H

#include "fmu_library.h"

/* What two clocks show: the machine's, and the processor's for this program. */
struct Moment {
  double machine, processor;
};
struct Moment moment(void);

/*
 * The processor's seconds since then, which other work on the machine hardly lengthens; of short times, which it rarely
 * interrupts, the machine's: where a virtual machine is denied its processor, that clock is set back by microseconds, and
 * the shortest of many times would be one of those.
 */
double seconds_since(struct Moment begin);

/* Resets the FMU and leaves its initialization mode; starts: REFERENCE=VALUE. */
int initialize(const struct FmuLibrary *fmu, fmi2Component c, double tolerance, int count, char **starts);

/* A line with the Real variables whose references are listed, with commas between them. */
int print_outputs(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

/* The same for Integer variables. */
int print_counts(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

#endif
