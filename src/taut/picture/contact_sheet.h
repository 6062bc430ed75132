#pragma once
// Several pictures side by side in one PNG file, with a title and a label under each: what
// happened, at a glance.

#include <filesystem>
#include <span>
#include <string>

#include "taut/picture/image.h"

namespace taut {

struct Tile {
  Image image;
  std::string label;  // one line of UTF-8, "t = 0.25 s"; may be empty
};

// The number of columns that write_contact_sheet takes by itself: up to 3 tiles in one row, then
// rows as square as can be with few gaps.
int contact_sheet_columns(int tile_count);

// Tiles row by row from the top left, on white; columns <= 0 chooses contact_sheet_columns. Tiles
// of different sizes are centred in cells of the largest. A text that does not fit is shortened
// with "…"; an empty title takes no room. The file is written whole or not at all. Throws
// InputError when there are no tiles, a tile's image is bad (check_image, with the tile's number),
// a text is not UTF-8, the sheet would exceed 32767 pixels a side, or the file cannot be written.
void write_contact_sheet(const std::filesystem::path& path, std::span<const Tile> tiles,
                         const std::string& title, int columns = 0);

}  // namespace taut
