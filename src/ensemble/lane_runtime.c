/* The parts of the FMU's runtime that ensembles use, compiled for lanes. */
#include "generated.h"

/* NOLINTBEGIN(bugprone-suspicious-include) */
#include "detection/chebyshev.c"
#include "support/instructions.c"
#include "support/ldlt.c"
#include "support/saddle.c"
/* NOLINTEND(bugprone-suspicious-include) */
