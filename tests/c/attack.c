/*
 * Calls an FMU at random in invalid ways, under sanitizers: attack LIBRARY GUID VARIABLES STATES CALLS SEED. Pointers
 * are NULL, references unknown, functions called in wrong states, numbers extreme, saved states damaged, or forged
 * with a valid checksum. Fails if a value that came with fmi2OK is not finite, a status is not in the standard, or
 * memory leaks. The same seed gives the same calls.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counted_memory.h"
#include "fmu_library.h"

/* bytes before the saved state; the last 8 are its checksum */
enum { LENGTH = 64, SAVED = 4, BYTES = 100000, HEADER = 64 };

static struct FmuLibrary fmu;
static const char *guid;
static size_t variables, states;
static long failures, right_steps, restored_states;
static uint64_t error_bound = 88172645463325252u;

static fmi2Component c;
static fmi2FMUstate saved[SAVED];
static double numbers[LENGTH], results[LENGTH];
static fmi2ValueReference references[LENGTH];
static fmi2Integer integers[LENGTH];
static double now; /* the communication point, if it is known */

/* xorshift64 */
static uint64_t random_below(uint64_t limit) {
  error_bound ^= error_bound << 13;
  error_bound ^= error_bound >> 7;
  error_bound ^= error_bound << 17;
  return error_bound % limit;
}

static bool one_in(uint64_t count) {
  return random_below(count) == 0;
}

static void *allocate(size_t count, size_t size) {
  return one_in(200) ? NULL : count_allocation(count, size);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
  (void)environment;
  if (name == NULL || status > fmi2Error || category == NULL || *message == '\0') failures++;
}

/* Returns mostly numbers of ordinary size. */
static double number(void) {
  static const double extremes[] = {0.0,    -0.0,    1e-9,     -1e-9,    1e9,       -1e9, 1e150,
                                    -1e300, 1.7e308, 4.9e-324, INFINITY, -INFINITY, NAN};
  if (one_in(12)) return extremes[random_below(sizeof extremes / sizeof *extremes)];
  return (double)random_below(4000) / 1000.0 - 1.0;
}

static void *or_null(void *pointer) {
  return one_in(25) ? NULL : pointer;
}

/* Fills the arguments. Returns how many of their elements the next call uses. */
static size_t draw(void) {
  for (int i = 0; i < LENGTH; i++) {
    numbers[i] = number();
    results[i] = 0.0;
    references[i] =
        one_in(30) ? (fmi2ValueReference)random_below(UINT32_MAX) : (fmi2ValueReference)random_below(variables);
    integers[i] = (fmi2Integer)random_below(6) - 1;
  }
  return random_below(one_in(8) ? LENGTH : 4);
}

static fmi2Status initialize(void) {
  fmu.fmi2Reset(c);
  now = 0.0;
  fmu.fmi2SetupExperiment(c, fmi2True, 1e-4, now, fmi2False, 0.0);
  fmu.fmi2EnterInitializationMode(c);
  fmi2Status status = fmu.fmi2ExitInitializationMode(c);
  fmi2EventInfo event;
  if (one_in(2) && fmu.fmi2NewDiscreteStates(c, &event) == fmi2OK) fmu.fmi2EnterContinuousTimeMode(c);
  return status;
}

static fmi2Status step(void) {
  /* without long steps, which may be valid and would take long */
  static const double wrong[] = {0.0, -1.0, 1e-300, 1e-16, INFINITY, NAN};
  double size = one_in(20) ? wrong[random_below(sizeof wrong / sizeof *wrong)] : 0.001 * (double)(1 + random_below(20));
  fmi2Status status = fmu.fmi2DoStep(c, one_in(20) ? number() : now, size, fmi2True);
  double reached = now;
  if (status == fmi2OK) {
    now += size;
    right_steps++;
  } else if (status == fmi2Discard && fmu.fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &reached) == fmi2OK)
    now = reached;
  return status;
}

/* Reads values; only finite ones may come with fmi2OK. */
static fmi2Status get(size_t count) {
  fmi2Status status;
  switch (random_below(5)) {
  case 0:
    status = fmu.fmi2GetRealOutputDerivatives(c, or_null(references), count, or_null(integers), or_null(results));
    break;
  case 1:
    status = fmu.fmi2GetDerivatives(c, or_null(results), one_in(10) ? count : states < LENGTH ? states : 0);
    break;
  case 2:
    status = fmu.fmi2GetContinuousStates(c, or_null(results), one_in(10) ? count : states < LENGTH ? states : 0);
    break;
  case 3:
    status = fmu.fmi2GetDirectionalDerivative(c, or_null(references), count, or_null(references + LENGTH / 2),
                                              count / 2, or_null(numbers), or_null(results));
    break;
  default: status = fmu.fmi2GetReal(c, or_null(references), count, or_null(results));
  }
  for (size_t i = 0; i < LENGTH && status == fmi2OK; i++)
    if (!isfinite(results[i])) failures++;
  return status;
}

static fmi2Status set(size_t count) {
  switch (random_below(6)) {
  case 0: return fmu.fmi2SetContinuousStates(c, or_null(numbers), states < LENGTH ? states : 0);
  case 1: return fmu.fmi2SetRealInputDerivatives(c, or_null(references), count, or_null(integers), or_null(numbers));
  case 2: return fmu.fmi2SetTime(c, number());
  case 3: return fmu.fmi2SetupExperiment(c, one_in(2), number(), number(), one_in(2), number());
  case 4: return fmu.fmi2SetInteger(c, or_null(references), count, or_null(integers));
  default: return fmu.fmi2SetReal(c, or_null(references), count, or_null(numbers));
  }
}

/* Sets the checksum: FNV-1a, as in src/runtime/instance/snapshot.c. */
static void sign(char *bytes, size_t size) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = HEADER; i < size; i++) hash = (hash ^ (unsigned char)bytes[i]) * 0x100000001b3u;
  memcpy(bytes + HEADER - sizeof hash, &hash, sizeof hash);
}

/* Overwrites a few numbers of the saved state. */
static void damage(char *bytes, size_t size) {
  for (uint64_t i = 0; i <= random_below(4); i++) {
    size_t slot = HEADER + 8 * random_below((size - HEADER) / 8);
    double value = number();
    int32_t small = (int32_t)random_below(40) - 5;
    if (one_in(2)) memcpy(bytes + slot, &value, sizeof value);
    else memcpy(bytes + slot, &small, sizeof small);
  }
}

static fmi2Status exercise_bytes(fmi2FMUstate *state) {
  static char bytes[BYTES];
  size_t size = 0;
  if (fmu.fmi2SerializedFMUstateSize(c, *state, &size) != fmi2OK || size > BYTES) return fmi2Error;
  fmi2Status status = fmu.fmi2SerializeFMUstate(c, *state, or_null(bytes), one_in(20) ? random_below(size) : size);
  if (status != fmi2OK) return status;
  if (one_in(2)) damage(bytes, size);
  if (one_in(2)) sign(bytes, size);
  return fmu.fmi2DeSerializeFMUstate(c, or_null(bytes), one_in(20) ? random_below(size + 1) : size, or_null(state));
}

static fmi2Status restore(fmi2FMUstate state) {
  fmi2Status status = fmu.fmi2SetFMUstate(c, state);
  if (status == fmi2OK) restored_states++;
  if (status == fmi2OK) fmu.fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &now);
  return status;
}

static fmi2Status exercise_state(void) {
  fmi2FMUstate *state = &saved[random_below(SAVED)];
  switch (random_below(4)) {
  case 0: return fmu.fmi2GetFMUstate(c, or_null(state));
  case 1: return fmu.fmi2FreeFMUstate(c, or_null(state));
  case 2: return *state == NULL ? fmi2OK : restore(*state);
  default: return *state == NULL ? fmi2OK : exercise_bytes(state);
  }
}

static fmi2Status change_mode(void) {
  fmi2EventInfo event;
  fmi2Boolean booleans[2];
  const fmi2String categories[] = {"logAll", "none", NULL};
  switch (random_below(10)) {
  case 0: return fmu.fmi2EnterInitializationMode(c);
  case 1: return fmu.fmi2ExitInitializationMode(c);
  case 2: return fmu.fmi2Terminate(c);
  case 3: return fmu.fmi2EnterEventMode(c);
  case 4: return fmu.fmi2NewDiscreteStates(c, or_null(&event));
  case 5: return fmu.fmi2EnterContinuousTimeMode(c);
  case 6: return fmu.fmi2CompletedIntegratorStep(c, one_in(2), or_null(&booleans[0]), or_null(&booleans[1]));
  case 7: return fmu.fmi2SetDebugLogging(c, one_in(2), random_below(4), or_null((void *)categories));
  case 8: return fmu.fmi2GetRealStatus(c, (fmi2StatusKind)random_below(6), or_null(results));
  default: return fmu.fmi2CancelStep(c);
  }
}

static void attack(long calls) {
  for (long call = 0; call < calls; call++) {
    size_t count = draw();
    uint64_t choice = random_below(20);
    fmi2Status status = choice < 8    ? step()
                        : choice < 12 ? get(count)
                        : choice < 16 ? set(count)
                        : choice < 19 ? exercise_state()
                                      : change_mode();
    if (status < fmi2OK || status > fmi2Error) failures++;
    if (status != fmi2OK && !one_in(4)) initialize();
  }
}

int main(int count, char **words) {
  if (count != 7) return 2;
  fmu = fmu_library_open(words[1]);
  guid = words[2];
  variables = strtoul(words[3], NULL, 10);
  states = strtoul(words[4], NULL, 10);
  error_bound ^= strtoull(words[6], NULL, 10) * 0x9E3779B97F4A7C15u; /* spreads small seeds */
  const fmi2CallbackFunctions callbacks = {logger, allocate, count_free, NULL, NULL};
  for (int type = fmi2ModelExchange; type <= fmi2CoSimulation; type++) {
    c = NULL;
    for (int tries = 0; tries < 1000 && c == NULL; tries++) /* allocations fail at times */
      c = fmu.fmi2Instantiate("attack", (fmi2Type)type, guid, NULL, &callbacks, fmi2False, fmi2True);
    if (c == NULL) {
      fprintf(stderr, "%s does not instantiate with the GUID %s\n", words[1], guid);
      return 1;
    }
    initialize();
    attack(strtol(words[5], NULL, 10));
    for (int i = 0; i < SAVED; i++) fmu.fmi2FreeFMUstate(c, &saved[i]);
    fmu.fmi2FreeInstance(c);
  }
  if (failures > 0 || blocks != 0) fprintf(stderr, "%ld failures, %ld blocks not given back\n", failures, blocks);
  printf("%ld right steps, %ld states restored\n", right_steps, restored_states);
  fmu_library_close(&fmu);
  return failures > 0 || blocks != 0;
}
