#include "meshes/stl.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "meshes/mesh_bytes.h"
#include "meshes/mesh_lines.h"

/* Bytes in the binary format: heading, offset of the count, size of a triangle, and of its normal. */
enum { HEADING = 84, COUNT_AT = 80, RECORD = 50, NORMAL = 12 };

/* Appends the last three points as a triangle. */
static bool append_facet(struct Mesh *mesh, char **problem) {
  size_t first = mesh->point_count - 3;
  return append_triangle(mesh, (size_t[]){first, first + 1, first + 2}, problem);
}

static bool read_record(const char *record, size_t number, struct Mesh *mesh, char **problem) {
  for (int corner = 0; corner < 3; corner++) {
    double point[3];
    for (int i = 0; i < 3; i++) {
      point[i] = mesh_number_at(record + NORMAL + (3 * corner + i) * MESH_NUMBER_SIZE);
      if (isfinite(point[i])) continue;
      *problem = format_text("has the coordinate %g in triangle %zu; expected finite numbers", point[i], number);
      return false;
    }
    append_mesh_point(mesh, point);
  }
  return append_facet(mesh, problem);
}

static bool read_binary(const char *bytes, size_t length, struct Mesh *mesh, char **problem) {
  size_t count = length >= HEADING ? mesh_word_at(bytes + COUNT_AT) : 0, there = length / RECORD;
  if (length < HEADING || count > there || HEADING + count * RECORD > length) {
    *problem =
        length < HEADING
            ? copy_text("is too short for STL; expected 84 bytes and 50 for each triangle")
            : format_text(
                  "is cut short: it has %zu triangles in its header, and %zu after it; expected a whole STL file",
                  count, (length - HEADING) / RECORD);
    return false;
  }
  for (size_t i = 0; i < count; i++)
    if (!read_record(bytes + HEADING + i * RECORD, i + 1, mesh, problem)) return false;
  return true;
}

static bool is_one_of(const char *word, const char *const *words) {
  size_t i = 0;
  while (words[i] != NULL && strcmp(word, words[i]) != 0) i++;
  return words[i] != NULL;
}

/* Reads one line of the text format. *corners counts the vertices of the current facet. */
static bool read_line(struct MeshLines *lines, const char *word, struct Mesh *mesh, size_t *corners) {
  static const char *const passed[] = {"solid", "endsolid", "facet", "outer", "endloop", NULL};
  if (strcmp(word, "vertex") == 0) {
    ++*corners;
    return append_point_of_line(lines, mesh);
  }
  if (strcmp(word, "endfacet") == 0) {
    if (*corners == 3) {
      *corners = 0;
      return append_facet(mesh, &lines->problem);
    }
    lines->problem =
        format_text("has a facet of %zu corners, which ends in line %ld; expected triangles", *corners, lines->line);
    return false;
  }
  if (is_one_of(word, passed)) return true;
  lines->problem = format_text("has '%s' in line %ld; expected STL, such as vertex 0 0.5 1", word, lines->line);
  return false;
}

static bool read_text(const char *text, struct Mesh *mesh, char **problem) {
  struct MeshLines lines = {.next = text, .line = 1};
  char word[24];
  size_t corners = 0;
  bool is_ended = false;
  do {
    if (!next_word(&lines, word, sizeof word)) continue;
    is_ended = strcmp(word, "endsolid") == 0;
    if (!read_line(&lines, word, mesh, &corners)) break;
  } while (next_line(&lines));
  if (lines.problem == NULL && (!is_ended || corners > 0))
    lines.problem = format_text("is cut short in line %ld; expected endsolid at its end", lines.line);
  *problem = lines.problem;
  return lines.problem == NULL;
}

/* True if the file is STL as text. Binary files may begin with "solid" too, but contain zero bytes. */
static bool is_text(const char *bytes, size_t length) {
  static const char solid[] = "solid";
  if (length < sizeof solid - 1 || memcmp(bytes, solid, sizeof solid - 1) != 0) return false;
  return memchr(bytes, '\0', length) == NULL;
}

bool stl_read(const char *bytes, size_t length, struct Mesh *mesh, char **problem) {
  return is_text(bytes, length) ? read_text(bytes, mesh, problem) : read_binary(bytes, length, mesh, problem);
}
