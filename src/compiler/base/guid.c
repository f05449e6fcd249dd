#include "base/guid.h"

#include <stdint.h>
#include <stdio.h>

/* Computes two 64-bit FNV-1a hashes from different bases; the second one also mixes its bits. */
void guid_of(const char *const *texts, size_t count, char guid[GUID_LENGTH]) {
  uint64_t a = 0xcbf29ce484222325u, b = 0x6c62272e07bb0142u;
  for (size_t i = 0; i < count; i++) {
    for (const unsigned char *c = (const unsigned char *)texts[i]; *c != '\0'; c++) {
      a = (a ^ *c) * 0x100000001b3u;
      b = (b ^ *c) * 0x100000001b3u;
      b ^= b >> 29;
    }
  }
  snprintf(guid, GUID_LENGTH, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(a >> 32), (unsigned)(a >> 16 & 0xffff),
           (unsigned)(a & 0xffff), (unsigned)(b >> 48), (unsigned long long)(b & 0xffffffffffffu));
}
