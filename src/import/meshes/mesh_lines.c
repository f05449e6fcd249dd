#include "meshes/mesh_lines.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* Largest number of triangles of a mesh, which bounds memory and time. */
enum { TRIANGLE_LIMIT = 1000000 };

/* Skips blanks and continued line ends. */
static void skip_blanks(struct MeshLines *lines) {
  for (;;) {
    const char *behind = lines->next + 1;
    if (*lines->next == '\\' && *behind == '\r') behind++;
    if (*lines->next == '\\' && *behind == '\n') {
      lines->next = behind + 1;
      lines->line++;
    } else if (*lines->next != '\n' && isspace((unsigned char)*lines->next)) lines->next++;
    else return;
  }
}

bool next_word(struct MeshLines *lines, char *word, size_t size) {
  size_t length = 0;
  skip_blanks(lines);
  for (; *lines->next != '\0' && !isspace((unsigned char)*lines->next); lines->next++)
    if (length + 1 < size) word[length++] = (char)tolower((unsigned char)*lines->next);
  word[length] = '\0';
  return length > 0;
}

bool next_line(struct MeshLines *lines) {
  char rest[2];
  while (next_word(lines, rest, sizeof rest)) continue;
  if (*lines->next == '\0') return false;
  lines->next++;
  lines->line++;
  return true;
}

bool append_point_of_line(struct MeshLines *lines, struct Mesh *mesh) {
  double point[3];
  char word[64];
  for (int i = 0; i < 3; i++) {
    char *end = word;
    if (next_word(lines, word, sizeof word)) point[i] = strtod(word, &end);
    if (end != word && *end == '\0' && isfinite(point[i])) continue;
    lines->problem =
        format_text("has in line %ld '%s' as a coordinate; expected three finite numbers", lines->line, word);
    return false;
  }
  append_mesh_point(mesh, point);
  return true;
}

void append_mesh_point(struct Mesh *mesh, const double point[3]) {
  mesh->points = make_room(mesh->points, mesh->point_count, sizeof *mesh->points);
  for (int i = 0; i < 3; i++) mesh->points[mesh->point_count][i] = point[i];
  mesh->point_count++;
}

bool append_triangle(struct Mesh *mesh, const size_t corners[3], char **problem) {
  if (mesh->triangle_count == TRIANGLE_LIMIT) {
    *problem = format_text(
        "has more than %d triangles; expected fewer, as programs for meshes such as MeshLab make them", TRIANGLE_LIMIT);
    return false;
  }
  mesh->triangles = make_room(mesh->triangles, mesh->triangle_count, sizeof *mesh->triangles);
  for (int i = 0; i < 3; i++) mesh->triangles[mesh->triangle_count][i] = corners[i];
  mesh->triangle_count++;
  return true;
}
