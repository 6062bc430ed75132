#include "taut/picture/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/picture/cairo_canvas.h"

namespace taut {

namespace {

// Where things stand, in pixels. Fonts follow the tiles' size within limits that stay readable.
struct Layout {
  int columns = 1, rows = 1;
  int cell_width = 0, cell_height = 0;
  int margin = 0, gap = 0, title_height = 0, label_height = 0;
  double title_size = 0.0, label_size = 0.0;

  int width() const { return 2 * margin + columns * cell_width + (columns - 1) * gap; }
  int height() const {
    return 2 * margin + title_height + rows * (cell_height + label_height) + (rows - 1) * gap;
  }
  int left(int tile) const { return margin + tile % columns * (cell_width + gap); }
  int top(int tile) const {
    return margin + title_height + tile / columns * (cell_height + label_height + gap);
  }
};

Layout make_layout(std::span<const Tile> tiles, bool has_title, int columns) {
  Layout layout;
  const int count = static_cast<int>(tiles.size());
  layout.columns = std::min(columns > 0 ? columns : contact_sheet_columns(count), count);
  layout.rows = (count + layout.columns - 1) / layout.columns;
  bool has_labels = false;
  for (const Tile& tile : tiles) {
    layout.cell_width = std::max(layout.cell_width, tile.image.width);
    layout.cell_height = std::max(layout.cell_height, tile.image.height);
    has_labels = has_labels || !tile.label.empty();
  }
  layout.label_size = std::clamp(layout.cell_width / 30.0, 11.0, 36.0);
  layout.title_size = 1.35 * layout.label_size;
  layout.gap = static_cast<int>(std::lround(0.8 * layout.label_size));
  layout.margin = static_cast<int>(std::lround(1.4 * layout.label_size));
  layout.title_height = has_title ? static_cast<int>(std::lround(2.0 * layout.title_size)) : 0;
  layout.label_height = has_labels ? static_cast<int>(std::lround(1.8 * layout.label_size)) : 0;
  return layout;
}

double text_width(cairo_t* context, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

// The text without its last character (which may take several bytes in UTF-8).
void drop_last_character(std::string& text) {
  while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U)
    text.pop_back();
  if (!text.empty()) text.pop_back();
}

std::string fitted(cairo_t* context, const std::string& text, double room) {
  if (text_width(context, text) <= room) return text;
  std::string kept = text;
  while (!kept.empty() && text_width(context, kept + "…") > room) drop_last_character(kept);
  return kept + "…";
}

// One line, its vertical middle at `middle`.
void draw_text(cairo_t* context, const std::string& text, double left, double middle, double room,
               double size, bool bold) {
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, size);
  cairo_font_extents_t font;
  cairo_font_extents(context, &font);
  cairo_set_source_rgb(context, 0.13, 0.14, 0.16);
  cairo_move_to(context, left, std::round(middle + 0.5 * (font.ascent - font.descent)));
  cairo_show_text(context, fitted(context, text, room).c_str());
  detail::check_cairo(cairo_status(context), "contact sheet: a title or label");
}

void draw_tile(cairo_t* context, const Tile& tile, const Layout& layout, int number) {
  const int left = layout.left(number), top = layout.top(number);
  const int x = left + (layout.cell_width - tile.image.width) / 2,
            y = top + (layout.cell_height - tile.image.height) / 2;
  const detail::CairoSurface picture = detail::to_cairo(tile.image);
  cairo_set_source_surface(context, picture.get(), x, y);
  cairo_rectangle(context, x, y, tile.image.width, tile.image.height);
  cairo_fill(context);
  if (!tile.label.empty())
    draw_text(context, tile.label, left, top + layout.cell_height + 0.5 * layout.label_height,
              layout.cell_width, layout.label_size, false);
}

}  // namespace

int contact_sheet_columns(int tile_count) {
  if (tile_count <= 3) return std::max(1, tile_count);
  const int start = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(tile_count))));
  // One column more is worth it when it fills the last row.
  return tile_count % start != 0 && tile_count % (start + 1) == 0 ? start + 1 : start;
}

void write_contact_sheet(const std::filesystem::path& path, std::span<const Tile> tiles,
                         const std::string& title, int columns) {
  if (tiles.empty()) throw InputError("contact sheet: no tiles, expected at least one");
  for (std::size_t i = 0; i < tiles.size(); ++i)
    check_image(tiles[i].image, fmt::format("contact sheet: tile {}", i).c_str());
  const Layout layout = make_layout(tiles, !title.empty(), columns);
  const detail::CairoSurface canvas = detail::make_canvas(layout.width(), layout.height());
  const detail::CairoContext context(cairo_create(canvas.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  if (!title.empty())
    draw_text(context.get(), title, layout.margin, layout.margin + 0.35 * layout.title_height,
              layout.width() - 2 * layout.margin, layout.title_size, true);
  for (std::size_t i = 0; i < tiles.size(); ++i)
    draw_tile(context.get(), tiles[i], layout, static_cast<int>(i));
  write_file(path, detail::encode_png(canvas.get()));
}

}  // namespace taut
