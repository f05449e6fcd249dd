/*
 * MSH (MuJoCo, XML reference, mesh) begins with the numbers of vertices, normals, texture coordinates and faces. Their
 * data follow: three numbers for each vertex and normal, two for each texture coordinate, three indices for each face.
 */
#include "meshes/msh.h"

#include <math.h>

#include "base/memory.h"
#include "meshes/mesh_bytes.h"
#include "meshes/mesh_lines.h"

enum { COUNTS = 4, VERTICES = 0, FACES = 3 };

static bool read_vertices(const char *bytes, size_t count, struct Mesh *mesh, char **problem) {
  for (size_t i = 0; i < count; i++) {
    double point[3];
    for (size_t k = 0; k < 3; k++) {
      point[k] = mesh_number_at(bytes + (3 * i + k) * MESH_NUMBER_SIZE);
      if (isfinite(point[k])) continue;
      *problem = format_text("has the coordinate %g in vertex %zu; expected finite numbers", point[k], i + 1);
      return false;
    }
    append_mesh_point(mesh, point);
  }
  return true;
}

static bool read_faces(const char *bytes, size_t count, struct Mesh *mesh, char **problem) {
  for (size_t i = 0; i < count; i++) {
    size_t corners[3];
    for (size_t k = 0; k < 3; k++) {
      corners[k] = mesh_word_at(bytes + (3 * i + k) * MESH_NUMBER_SIZE);
      if (corners[k] < mesh->point_count) continue;
      *problem = format_text("has the vertex %zu in face %zu, of %zu; expected numbers from 0", corners[k], i + 1,
                             mesh->point_count);
      return false;
    }
    if (!append_triangle(mesh, corners, problem)) return false;
  }
  return true;
}

bool msh_read(const char *bytes, size_t length, struct Mesh *mesh, char **problem) {
  static const size_t widths[COUNTS] = {3, 3, 2, 3};
  size_t count[COUNTS], words = COUNTS, start[COUNTS], there = length / MESH_NUMBER_SIZE;
  for (size_t i = 0; i < COUNTS; i++) {
    count[i] = there >= COUNTS ? mesh_word_at(bytes + i * MESH_NUMBER_SIZE) : 0;
    start[i] = words * MESH_NUMBER_SIZE;
    words += count[i] * widths[i];
  }
  if (words != there || length % MESH_NUMBER_SIZE != 0) {
    *problem = format_text("has %zu bytes, and by its header %zu; expected MSH as MuJoCo writes it", length,
                           words * MESH_NUMBER_SIZE);
    return false;
  }
  return read_vertices(bytes + start[VERTICES], count[VERTICES], mesh, problem) &&
         read_faces(bytes + start[FACES], count[FACES], mesh, problem);
}
