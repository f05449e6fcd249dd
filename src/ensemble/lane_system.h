/*
 * The generated system for lanes: include/lagrangian.h with the types of this folder. The same library has the system
 * for single runs (single/single_run.h), so that names of both get a prefix here.
 */
#pragma once

#include "lane_limit.h"
#include "lane_real.h"
#include "lane_series.h"

#define lagrangian lane_lagrangian
#define chebyshev_time lane_chebyshev_time
#define chebyshev_times lane_chebyshev_times
#define chebyshev_coefficients lane_chebyshev_coefficients
#define chebyshev_range lane_chebyshev_range
#define chebyshev_tail lane_chebyshev_tail
#define chebyshev_derivative lane_chebyshev_derivative
#define chebyshev_powers lane_chebyshev_powers
#define chebyshev_value lane_chebyshev_value
#define instructions_frame lane_instructions_frame
#define instructions_seed lane_instructions_seed
#define instructions_run lane_instructions_run
#define instructions_run_order lane_instructions_run_order
#define instructions_limit lane_instructions_limit
#define ldlt_factor lane_ldlt_factor
#define ldlt_solve lane_ldlt_solve
#define saddle_null_vector lane_saddle_null_vector
#define saddle_factor lane_saddle_factor
#define saddle_solve lane_saddle_solve
#define saddle_least_forces lane_saddle_least_forces

#include "instructions.h"
#include "lagrangian.h"
#include "ldlt.h"
#include "saddle.h"
