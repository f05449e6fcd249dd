#include "model/drawn_line.h"

const char *const line_kind_names[LINE_KINDS] = {
    [LINE_ROD] = "rod",     [LINE_ROPE] = "rope",   [LINE_SPRING] = "spring", [LINE_DAMPER] = "damper",
    [LINE_BELT] = "belt",   [LINE_HOOP] = "hoop",   [LINE_WHEEL] = "wheel",   [LINE_GROUND] = "ground",
    [LINE_PIVOT] = "pivot", [LINE_ARROW] = "arrow",
};

bool has_described_lines(const struct LineDrawing *drawing) {
  bool has = false;
  for (size_t i = 0; i < drawing->count; i++) has |= !drawing->lines[i].is_guessed;
  return has;
}

bool has_two_ends(const struct DrawnLine *line) {
  return line->kind != LINE_PIVOT;
}
