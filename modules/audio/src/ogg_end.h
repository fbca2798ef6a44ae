#pragma once
#include "input_file.h"

namespace mien {

/// Whether an Ogg file ends with a complete page that is marked as the last one. Nothing else in the file
/// tells how long it should be.
bool ogg_is_complete(InputFile& file);

}  // namespace mien
