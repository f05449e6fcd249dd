#include "meshes/mesh_file.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "meshes/msh.h"
#include "meshes/obj.h"
#include "meshes/stl.h"

/* Bytes: largest file, enough for a million triangles as text, and the unit of reading. */
enum { LENGTH_LIMIT = 500000000, CHUNK = 1 << 16 };

/* Returns all bytes of the file followed by a terminating zero; NULL with a message in *problem on errors. */
static char *bytes_of_file(const char *path, size_t *length, char **problem) {
  FILE *file = fopen(path, "rb");
  size_t room = CHUNK, got = 0;
  char *bytes = NULL;
  *length = 0;
  do {
    if (file == NULL) break;
    if (*length + CHUNK + 1 > room || bytes == NULL) bytes = reallocate(bytes, (room *= 2), 1);
    got = fread(bytes + *length, 1, CHUNK, file);
    *length += got;
  } while (got == CHUNK && *length <= LENGTH_LIMIT);
  bool is_read = file != NULL && ferror(file) == 0;
  if (!is_read)
    *problem = format_text("cannot be read: %s; expected an STL or OBJ file, with a path relative to this file",
                           strerror(errno));
  else if (*length > LENGTH_LIMIT)
    *problem = format_text("is longer than %d bytes; expected a shorter one", LENGTH_LIMIT);
  if (file != NULL) fclose(file);
  if (is_read && *length <= LENGTH_LIMIT) {
    bytes[*length] = '\0';
    return bytes;
  }
  release(bytes);
  return NULL;
}

/* True if the path has this ending; case is ignored. */
static bool ends_with(const char *path, const char *ending) {
  size_t length = strlen(path), size = strlen(ending);
  bool is_same = length >= size;
  for (size_t i = 0; i < size && is_same; i++) is_same = tolower((unsigned char)path[length - size + i]) == ending[i];
  return is_same;
}

/* Removes points that no triangle uses: they are not part of the surface. */
static void drop_unused_points(struct Mesh *mesh) {
  size_t *indices = allocate(mesh->point_count, sizeof *indices), kept = 0;
  for (size_t i = 0; i < mesh->triangle_count; i++)
    for (int k = 0; k < 3; k++) indices[mesh->triangles[i][k]] = 1;
  for (size_t i = 0; i < mesh->point_count; i++) {
    if (indices[i] == 0) continue;
    for (int axis = 0; axis < 3; axis++) mesh->points[kept][axis] = mesh->points[i][axis];
    indices[i] = kept++;
  }
  for (size_t i = 0; i < mesh->triangle_count; i++)
    for (int k = 0; k < 3; k++) mesh->triangles[i][k] = indices[mesh->triangles[i][k]];
  mesh->point_count = kept;
  release(indices);
}

/* Scales the points. A reflection reverses the order of corners, which is restored so that normals stay outward. */
static void apply_scale(struct Mesh *mesh, const double scale[3]) {
  for (size_t i = 0; i < mesh->point_count; i++)
    for (int axis = 0; axis < 3; axis++) mesh->points[i][axis] *= scale[axis];
  for (size_t i = 0; i < mesh->triangle_count && scale[0] * scale[1] * scale[2] < 0.0; i++) {
    size_t second = mesh->triangles[i][1];
    mesh->triangles[i][1] = mesh->triangles[i][2];
    mesh->triangles[i][2] = second;
  }
}

static bool has_usual_size(const struct Mesh *mesh) {
  static const double most = 1e9, least = 1e-9; /* m, limits of the largest coordinate */
  double largest = 0.0;
  for (size_t i = 0; i < mesh->point_count; i++)
    for (int axis = 0; axis < 3; axis++) largest = fmax(largest, fabs(mesh->points[i][axis]));
  return largest <= most && largest >= least;
}

static bool read_bytes(const char *path, struct Mesh *mesh, char **problem) {
  bool is_stl = ends_with(path, ".stl"), is_msh = ends_with(path, ".msh");
  if (!is_stl && !is_msh && !ends_with(path, ".obj")) {
    *problem = copy_text("has an unknown format; expected STL or OBJ, as Blender or MeshLab write them, or MSH");
    return false;
  }
  size_t length;
  char *bytes = bytes_of_file(path, &length, problem);
  if (bytes == NULL) return false;
  bool is_right = is_stl   ? stl_read(bytes, length, mesh, problem)
                  : is_msh ? msh_read(bytes, length, mesh, problem)
                           : obj_read(bytes, mesh, problem);
  release(bytes);
  return is_right;
}

struct Mesh *mesh_read(const char *path, const double scale[3], char **problem) {
  struct Mesh *mesh = allocate(1, sizeof *mesh);
  char *wrong = NULL;
  if (read_bytes(path, mesh, &wrong)) {
    drop_unused_points(mesh);
    apply_scale(mesh, scale);
    if (mesh->triangle_count == 0) wrong = copy_text("is empty; expected triangles");
    else if (!has_usual_size(mesh))
      wrong = copy_text("reaches beyond 1e9 m, or no further than 1e-9 m; expected another scale");
  }
  if (wrong == NULL) return mesh;
  *problem = format_text("the mesh '%s' %s", path, wrong);
  return NULL;
}
