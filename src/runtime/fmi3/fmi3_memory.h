/* Memory of instances, which FMI 3.0 leaves to the FMU: that of the C library. */
#ifndef FMI3_MEMORY_H
#define FMI3_MEMORY_H

#include "instance/instance.h"

extern const struct Allocator fmi3_memory;

#endif
