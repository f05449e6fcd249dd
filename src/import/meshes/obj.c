#include "meshes/obj.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "meshes/mesh_lines.h"

/* Sets the index of the point in a corner such as 3, 3/1/2, or -1 for the last. Returns false for none. */
static bool read_corner(const char *word, const struct Mesh *mesh, size_t *index) {
  char *end;
  long long number = strtoll(word, &end, 10), count = (long long)mesh->point_count;
  if (end == word || (*end != '\0' && *end != '/')) return false;
  if (number == 0 || number > count || number < -count) return false;
  *index = (size_t)(number > 0 ? number - 1 : count + number);
  return true;
}

/* Splits a polygon into a fan of triangles about its first corner. */
static bool read_polygon(struct MeshLines *lines, struct Mesh *mesh) {
  size_t triangle[3] = {0}, count = 0;
  char word[64];
  while (next_word(lines, word, sizeof word) && *word != '#') {
    if (!read_corner(word, mesh, &triangle[count < 2 ? count : 2])) {
      lines->problem =
          format_text("has the corner '%s' in line %ld; expected the number of a point above it, from 1 to "
                      "%zu, or negative to count back",
                      word, lines->line, mesh->point_count);
      return false;
    }
    count++;
    if (count < 3) continue;
    if (!append_triangle(mesh, triangle, &lines->problem)) return false;
    triangle[1] = triangle[2];
  }
  if (count < 3)
    lines->problem =
        format_text("has a polygon of %zu corners in line %ld; expected three or more", count, lines->line);
  return count >= 3;
}

bool obj_read(const char *text, struct Mesh *mesh, char **problem) {
  struct MeshLines lines = {.next = text, .line = 1};
  char word[24];
  bool is_right = true;
  do {
    if (!next_word(&lines, word, sizeof word)) continue;
    if (strcmp(word, "v") == 0) is_right = append_point_of_line(&lines, mesh);
    else if (strcmp(word, "f") == 0) is_right = read_polygon(&lines, mesh);
  } while (is_right && next_line(&lines));
  *problem = lines.problem;
  return is_right;
}
