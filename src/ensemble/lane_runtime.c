/* The parts of the runtime of FMUs that lanes take, compiled over them. */
#include "generated.h"

/* NOLINTBEGIN(bugprone-suspicious-include) */
#include "events/chebyshev.c"
#include "support/instructions.c"
#include "support/ldlt.c"
#include "support/saddle.c"
/* NOLINTEND(bugprone-suspicious-include) */
