/* Types without variables, and clocks (sections 2.2.6 and 2.2.8). */
#include "fmi/values.h"
#include "fmi3/fmi3_component.h"

/* Defines the functions of one type. */
#define NO_VARIABLES(type, setter)                                                                                     \
  fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##type values[],             \
                           size_t nValues) {                                                                           \
    (void)vr;                                                                                                          \
    (void)values;                                                                                                      \
    (void)nValues;                                                                                                     \
    return status_of(values_none(c, FUNCTION_GET_VALUE, nvr, __func__));                                               \
  }                                                                                                                    \
  NO_SETTER(type, setter)
#define NO_SETTER(type, function)                                                                                      \
  fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3##type values[],       \
                           size_t nValues) {                                                                           \
    (void)vr;                                                                                                          \
    (void)values;                                                                                                      \
    (void)nValues;                                                                                                     \
    return status_of(values_none(c, function, nvr, __func__));                                                         \
  }

NO_VARIABLES(Float32, FUNCTION_SET_REAL)
NO_VARIABLES(Int8, FUNCTION_SET_DISCRETE)
NO_VARIABLES(UInt8, FUNCTION_SET_DISCRETE)
NO_VARIABLES(Int16, FUNCTION_SET_DISCRETE)
NO_VARIABLES(UInt16, FUNCTION_SET_DISCRETE)
NO_VARIABLES(UInt32, FUNCTION_SET_DISCRETE)
NO_VARIABLES(UInt64, FUNCTION_SET_DISCRETE)
NO_VARIABLES(String, FUNCTION_SET_DISCRETE)
/* Variables of type Int64 are statistics, which are read-only. */
NO_SETTER(Int64, FUNCTION_SET_DISCRETE)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, size_t valueSizes[],
                         fmi3Binary values[], size_t nValues) {
  (void)vr;
  (void)valueSizes;
  (void)values;
  (void)nValues;
  return status_of(values_none(c, FUNCTION_GET_VALUE, nvr, __func__));
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues) {
  (void)vr;
  (void)valueSizes;
  (void)values;
  (void)nValues;
  return status_of(values_none(c, FUNCTION_SET_DISCRETE, nvr, __func__));
}

/* Defines a function for clocks, with its further parameters. */
#define NO_CLOCKS(function, parameters, ...)                                                                           \
  fmi3Status function parameters {                                                                                     \
    const void *unused[] = {__VA_ARGS__};                                                                              \
    (void)unused;                                                                                                      \
    (void)nvr;                                                                                                         \
    enter(c, FUNCTION_NEVER, __func__);                                                                                \
    return fmi3Error;                                                                                                  \
  }
#define REFERENCES fmi3Instance c, const fmi3ValueReference vr[], size_t nvr

NO_CLOCKS(fmi3GetClock, (REFERENCES, fmi3Clock values[]), vr, values)
NO_CLOCKS(fmi3SetClock, (REFERENCES, const fmi3Clock values[]), vr, values)
NO_CLOCKS(fmi3GetIntervalDecimal, (REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]), vr,
          intervals, qualifiers)
NO_CLOCKS(fmi3GetIntervalFraction,
          (REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]), vr,
          counters, resolutions, qualifiers)
NO_CLOCKS(fmi3GetShiftDecimal, (REFERENCES, fmi3Float64 shifts[]), vr, shifts)
NO_CLOCKS(fmi3GetShiftFraction, (REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]), vr, counters,
          resolutions)
NO_CLOCKS(fmi3SetIntervalDecimal, (REFERENCES, const fmi3Float64 intervals[]), vr, intervals)
NO_CLOCKS(fmi3SetIntervalFraction, (REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]), vr,
          counters, resolutions)
NO_CLOCKS(fmi3SetShiftDecimal, (REFERENCES, const fmi3Float64 shifts[]), vr, shifts)
NO_CLOCKS(fmi3SetShiftFraction, (REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]), vr, counters,
          resolutions)
