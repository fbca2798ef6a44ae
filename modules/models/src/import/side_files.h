#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/io/pickle.h"
#include "mien/models/model_file.h"

namespace mien {

using Templates = std::vector<std::pair<std::string, std::vector<float>>>;

/// Neutral faces by subject: a pickled dictionary of arrays [V, 3] or [3 V], vertex by vertex. Errors: as
/// Pickle::open(); (Errc::incompatible): something else inside, or another number of coordinates than
/// `channels`.
Result<Templates> read_templates(const std::filesystem::path& path, std::int64_t channels);

struct Region {
  std::string name;
  std::vector<std::int64_t> vertices;  ///< ascending
};
/// "mouth=lve.txt" or "lve.txt" (lve: mouth, fdd: upper, else the stem). The file lists vertex numbers with
/// commas, blanks or line ends between them; or one weight per vertex, of which those above 0.1 (above 0.4 in
/// a file called forehead ...) belong to the region. Errors (Errc::input): unreadable; (Errc::incompatible):
/// a number that is no vertex.
Result<Region> read_region(const std::string& argument, std::int64_t num_vertices);

}  // namespace mien
