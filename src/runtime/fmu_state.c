/* Saving, restoring and serializing the state of an instance (section 2.1.8). */
#include <stdint.h>
#include <string.h>

#include "check.h"
#include "log.h"

/* Comes before the situation in memory and in the serialized form, which is a copy of both. */
struct Header {
  char magic[8];
  uint32_t version;
  uint32_t size; /* of the situation */
  char guid[40];
  uint64_t checksum; /* of the situation */
};

static const char magic[8] = {'l', 'a', 'g', 'r', 'a', 'n', 'g', 'e'};
enum { VERSION = 1 };

static size_t block_size(void) {
  return sizeof(struct Header) + situation_size();
}

/* FNV-1a */
static uint64_t checksum_of(const void *data, size_t size) {
  const unsigned char *bytes = data;
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

static struct Header header_of(const void *situation) {
  struct Header header = {.version = VERSION, .size = (uint32_t)situation_size()};
  memcpy(header.magic, magic, sizeof magic);
  strncpy(header.guid, lagrangian.guid, sizeof header.guid - 1);
  header.checksum = checksum_of(situation, situation_size());
  return header;
}

/* What is wrong with a block that claims to be a state of this FMU; NULL where nothing is. */
static const char *fault_of(const struct Instance *instance, const void *block, size_t size) {
  struct Header header;
  if (size < sizeof header) return "they are cut off";
  memcpy(&header, block, sizeof header);
  if (memcmp(header.magic, magic, sizeof magic) != 0) return "they are no state of such an FMU";
  if (header.version != VERSION) return "they are of another version";
  if (strncmp(header.guid, lagrangian.guid, sizeof header.guid) != 0) return "they are of another model";
  if (size != block_size()) return "they have another length";
  const char *situation = (const char *)block + sizeof header;
  struct Header expected = header_of(situation);
  struct Situation fixed;
  memcpy(&fixed, situation, sizeof fixed);
  if (memcmp(&header, &expected, sizeof header) != 0 || fixed.mode < 0 || fixed.mode >= MODE_COUNT)
    return "they are damaged";
  return fixed.type == (int32_t)instance->type ? NULL : "they are of the other kind of instance";
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2GetFMUstate") ||
      !check_array(instance, FMUstate, 1, "fmi2GetFMUstate", "FMUstate"))
    return fmi2Error;
  if (*FMUstate == NULL) *FMUstate = instance->allocate(1, block_size());
  if (*FMUstate == NULL) return log_error(instance, "fmi2GetFMUstate: allocateMemory returned no memory");
  struct Header header = header_of(instance->situation);
  memcpy(*FMUstate, &header, sizeof header);
  memcpy((char *)*FMUstate + sizeof header, instance->situation, situation_size());
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2SetFMUstate") ||
      !check_array(instance, FMUstate, 1, "fmi2SetFMUstate", "FMUstate"))
    return fmi2Error;
  const char *fault = fault_of(instance, FMUstate, block_size());
  if (fault != NULL) return log_error(instance, "fmi2SetFMUstate: the bytes of the state cannot be used: %s", fault);
  memcpy(instance->situation, (const char *)FMUstate + sizeof(struct Header), situation_size());
  instance->prepared_is_stale = instance->solver_is_stale = true;
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2FreeFMUstate")) return fmi2Error;
  if (FMUstate == NULL || *FMUstate == NULL) return fmi2OK;
  instance->free(*FMUstate);
  *FMUstate = NULL;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2SerializedFMUstateSize") ||
      !check_array(instance, FMUstate, 1, "fmi2SerializedFMUstateSize", "FMUstate") ||
      !check_array(instance, size, 1, "fmi2SerializedFMUstateSize", "size"))
    return fmi2Error;
  *size = block_size();
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2SerializeFMUstate") ||
      !check_array(instance, FMUstate, 1, "fmi2SerializeFMUstate", "FMUstate") ||
      !check_array(instance, serializedState, 1, "fmi2SerializeFMUstate", "serializedState"))
    return fmi2Error;
  if (size < block_size())
    return log_error(instance, "fmi2SerializeFMUstate: the size is %zu; expected %zu", size, block_size());
  memcpy(serializedState, FMUstate, block_size());
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_FMU_STATE, "fmi2DeSerializeFMUstate") ||
      !check_array(instance, serializedState, size, "fmi2DeSerializeFMUstate", "serializedState") ||
      !check_array(instance, FMUstate, 1, "fmi2DeSerializeFMUstate", "FMUstate"))
    return fmi2Error;
  const char *fault = fault_of(instance, serializedState, size);
  if (fault != NULL) return log_error(instance, "fmi2DeSerializeFMUstate: the bytes cannot be used: %s", fault);
  if (*FMUstate == NULL) *FMUstate = instance->allocate(1, block_size());
  if (*FMUstate == NULL) return log_error(instance, "fmi2DeSerializeFMUstate: allocateMemory returned no memory");
  memcpy(*FMUstate, serializedState, block_size());
  return fmi2OK;
}
