/* Precedes a generated system compiled for lanes: replaces the functions of math.h by those of lane_functions.h. */
#ifndef GENERATED_H
#define GENERATED_H

#include "lane_functions.h"
#include "lane_system.h"

#define sqrt(x) lanes_sqrt(LANES_OF(x))
#define sin(x) lanes_sin(LANES_OF(x))
#define cos(x) lanes_cos(LANES_OF(x))
#define tan(x) lanes_tan(LANES_OF(x))
#define asin(x) lanes_asin(LANES_OF(x))
#define acos(x) lanes_acos(LANES_OF(x))
#define atan(x) lanes_atan(LANES_OF(x))
#define sinh(x) lanes_sinh(LANES_OF(x))
#define cosh(x) lanes_cosh(LANES_OF(x))
#define tanh(x) lanes_tanh(LANES_OF(x))
#define asinh(x) lanes_asinh(LANES_OF(x))
#define acosh(x) lanes_acosh(LANES_OF(x))
#define atanh(x) lanes_atanh(LANES_OF(x))
#define exp(x) lanes_exp(LANES_OF(x))
#define log(x) lanes_log(LANES_OF(x))
#define floor(x) lanes_floor(LANES_OF(x))
#define logistic(x) lanes_logistic(LANES_OF(x))
#define softplus(x) lanes_softplus(LANES_OF(x))
#define sech(x) lanes_sech(LANES_OF(x))
#define log_cosh(x) lanes_log_cosh(LANES_OF(x))
#define capped_exp(x) lanes_capped_exp(LANES_OF(x))
#define capped_exp_slope(x) lanes_capped_exp_slope(LANES_OF(x))
#define fabs(x) lanes_absolute(LANES_OF(x))
#define pow(x, y) lanes_pow(LANES_OF(x), LANES_OF(y))
#define atan2(y, x) lanes_atan2(LANES_OF(y), LANES_OF(x))
#define random_uniform(x, y) lanes_random_uniform(LANES_OF(x), LANES_OF(y))
#define random_gauss(x, y) lanes_random_gauss(LANES_OF(x), LANES_OF(y))
#define fmin(x, y) lanes_smaller(LANES_OF(x), LANES_OF(y))
#define fmax(x, y) lanes_larger(LANES_OF(x), LANES_OF(y))

#endif
