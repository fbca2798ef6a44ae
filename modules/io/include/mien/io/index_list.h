#pragma once
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// Vertex numbers from text, counted from 0: whole numbers apart by blanks, commas, semicolons or new lines,
/// and ranges "3-7" with both ends; '#' begins a comment. Their order is kept, as landmark files need it
/// (SAiD specification, section 10.1). Errors (Errc::input), each with its line: anything else, numbers of
/// `num_vertices` or more, ranges that run backwards.
Result<std::vector<std::uint32_t>> read_index_list(std::string_view text, std::size_t num_vertices);

/// Pairs of vertex numbers, one a line: "12,345" or "12 345". '#' begins a comment; a first line of words is
/// a heading. Errors (Errc::input), each with its line: lines of another form, numbers of 2^32 or more.
Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> read_index_pairs(std::string_view text);

}  // namespace mien
