/* The generated system over lanes: include/lagrangian.h with the types of this folder. */
#ifndef LANE_SYSTEM_H
#define LANE_SYSTEM_H

#include "lane_limit.h"
#include "lane_real.h"
#include "lane_series.h"

#include "lagrangian.h"

#endif
