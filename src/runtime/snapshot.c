#include "snapshot.h"

#include <string.h>

/* Comes before the situation in the block. */
struct Header {
  char magic[8];
  uint32_t version;
  uint32_t size; /* of the situation */
  char guid[40];
  uint64_t checksum; /* of the situation */
};

static const char magic[8] = {'l', 'a', 'g', 'r', 'a', 'n', 'g', 'e'};
enum { VERSION = 2 };

size_t snapshot_size(void) {
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

const char *snapshot_fault(const struct Instance *instance, const void *block, size_t size) {
  struct Header header;
  if (size < sizeof header) return "they are cut off";
  memcpy(&header, block, sizeof header);
  if (memcmp(header.magic, magic, sizeof magic) != 0) return "they are no state of such an FMU";
  if (header.version != VERSION) return "they are of another version";
  if (strncmp(header.guid, lagrangian.guid, sizeof header.guid) != 0) return "they are of another model";
  if (size != snapshot_size()) return "they have another length";
  const char *situation = (const char *)block + sizeof header;
  struct Header expected = header_of(situation);
  struct Situation fixed;
  memcpy(&fixed, situation, sizeof fixed);
  if (memcmp(&header, &expected, sizeof header) != 0 || fixed.mode < 0 || fixed.mode >= MODE_COUNT)
    return "they are damaged";
  return fixed.kind == (int32_t)instance->kind ? NULL : "they are of the other kind of instance";
}

void snapshot_take(const struct Instance *instance, void *block) {
  struct Header header = header_of(instance->situation);
  memcpy(block, &header, sizeof header);
  memcpy((char *)block + sizeof header, instance->situation, situation_size());
}

void snapshot_restore(struct Instance *instance, const void *block) {
  memcpy(instance->situation, (const char *)block + sizeof(struct Header), situation_size());
  instance->prepared_is_stale = instance->solver_is_stale = true;
}
