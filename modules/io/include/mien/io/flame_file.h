#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/flame_model.h"

namespace mien {

/// Reads a FLAME model: the pickle of the published releases (generic_model.pkl, with chumpy's and scipy's
/// objects taken as data), or an .npz of plain arrays under the same names: v_template, shapedirs, posedirs,
/// J_regressor, weights, kintree_table, f. Nothing in the file is run. Other members are ignored. Errors:
/// those of Pickle::open() and ZipFile; (Errc::incompatible): a missing member, another number of joints,
/// shapes that do not fit each other, numbers that are not finite, triangles of vertices that do not exist -
/// each with the member's name.
Result<FlameModel> read_flame_model(const std::filesystem::path& path);
/// The same from memory; `name` stands for the file in messages.
Result<FlameModel> parse_flame_model(std::span<const std::byte> bytes, std::string_view name);

}  // namespace mien
