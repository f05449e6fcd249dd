/* Memory of instances, which FMI 3.0 leaves to the FMU: that of the C library. */
#pragma once

#include "instance/instance.h"

extern const struct Allocator fmi3_memory;
