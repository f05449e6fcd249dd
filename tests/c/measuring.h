/* Shared by the programs that time an FMU. Functions return 0 if the FMU fails. */
#ifndef MEASURING_H
#define MEASURING_H

#include "fmu_library.h"

/* The times of two clocks in s: the wall clock, and the processor time of this program. */
struct Moment {
  double machine, processor;
};
struct Moment moment(void);

/*
 * Returns the processor time since then, which other processes hardly affect; for times below 1 ms, the wall-clock
 * time. When a virtual machine is descheduled, its processor clock may go back by microseconds. The shortest of
 * many short times would be such an outlier.
 */
double seconds_since(struct Moment begin);

/* Resets and initializes the FMU; starts: REFERENCE=VALUE. */
int initialize(const struct FmuLibrary *fmu, fmi2Component c, double tolerance, int count, char **starts);

/* Prints a line with the Real variables in a comma-separated list of references. */
int print_outputs(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

/* Does the same for Integer variables. */
int print_counts(const struct FmuLibrary *fmu, fmi2Component c, const char *references);

#endif
