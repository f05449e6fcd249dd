/*
 * Runs the readers of meshes on arbitrary bytes, for libFuzzer (scripts/fuzz); the first byte selects the format.
 * Meshes must have valid indices, a hull, and a packed form for pages.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "model/hull.h"
#include "meshes/obj.h"
#include "meshes/stl.h"
#include "scene/packed_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void use(struct Mesh *mesh) {
  for (size_t i = 0; i < mesh->triangle_count; i++)
    for (int k = 0; k < 3; k++)
      if (mesh->triangles[i][k] >= mesh->point_count) abort();
  for (size_t i = 0; i < mesh->point_count; i++)
    for (int axis = 0; axis < 3; axis++) /* as mesh_read() guarantees */
      if (!(mesh->points[i][axis] >= -1e9 && mesh->points[i][axis] <= 1e9)) return;
  if (mesh->triangle_count == 0) return;
  if (mesh_find_corners(mesh) != (mesh->corner_count >= 4)) abort();
  pack_mesh(mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return 0;
  struct Mesh mesh = {.point_count = 0};
  char *bytes = allocate(size, 1), *problem = NULL;
  memcpy(bytes, data + 1, size - 1); /* followed by a terminating zero */
  bool is_right = data[0] % 2 != 0 ? obj_read(bytes, &mesh, &problem) : stl_read(bytes, size - 1, &mesh, &problem);
  if (is_right != (problem == NULL)) abort();
  if (is_right) use(&mesh);
  release_all();
  return 0;
}
