#include "mien/io/index_list.h"

#include <charconv>
#include <string>

namespace mien {
namespace {

constexpr std::string_view kApart = " \t\r,;";

Error bad_index_line(std::size_t line, const std::string& why, const std::string& fix) {
  return {Errc::input, "line " + std::to_string(line), why, fix};
}

// Calls use(line number, words of the line); stops at its first error.
template <class Use>
Status for_each_line(std::string_view text, Use&& use) {
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view rest = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    rest = rest.substr(0, rest.find('#'));
    std::vector<std::string_view> words;
    for (;;) {
      const std::size_t first = rest.find_first_not_of(kApart);
      if (first == std::string_view::npos) break;
      rest = rest.substr(first);
      words.push_back(rest.substr(0, rest.find_first_of(kApart)));
      rest = rest.substr(words.back().size());
    }
    if (words.empty()) continue;
    if (const Status used = use(line, words); !used) return used.error();
  }
  return Done{};
}

bool parse_index(std::string_view word, std::uint32_t& value) {
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  return problem == std::errc() && end == word.data() + word.size();
}

std::string quoted(std::string_view word) { return "'" + std::string(word.substr(0, 40)) + "'"; }

}  // namespace

Result<std::vector<std::uint32_t>> read_index_list(std::string_view text, std::size_t num_vertices) {
  std::vector<std::uint32_t> indices;
  const auto add_word = [&](std::size_t line, std::string_view word) -> Status {
    const std::size_t dash = word.find('-');
    std::uint32_t first = 0, last = 0;
    if (!parse_index(word.substr(0, dash), first))
      return bad_index_line(line, quoted(word) + " is no vertex number",
                            "Write numbers from 0, or ranges as 3-7");
    last = first;
    if (dash != std::string_view::npos && !parse_index(word.substr(dash + 1), last))
      return bad_index_line(line, quoted(word) + " is no range of vertices", "Write ranges as 3-7");
    if (last < first) return bad_index_line(line, quoted(word) + " runs backwards", "");
    if (last >= num_vertices)
      return bad_index_line(
          line,
          "vertex " + std::to_string(last) + " does not exist: there are " + std::to_string(num_vertices),
          "Vertices are counted from 0");
    for (std::uint32_t v = first; v <= last; ++v) indices.push_back(v);
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto read,
           for_each_line(text, [&](std::size_t line, const std::vector<std::string_view>& words) -> Status {
             for (const auto word : words)
               if (const Status added = add_word(line, word); !added) return added.error();
             return Done{};
           }));
  return indices;
}

Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> read_index_pairs(std::string_view text) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  bool is_first = true;
  MIEN_TRY([[maybe_unused]] const auto read,
           for_each_line(text, [&](std::size_t line, const std::vector<std::string_view>& words) -> Status {
             std::uint32_t a = 0, b = 0;
             const bool may_be_heading = std::exchange(is_first, false);
             if (words.size() == 2 && parse_index(words[0], a) && parse_index(words[1], b)) {
               pairs.emplace_back(a, b);
               return Done{};
             }
             if (may_be_heading && words[0].find_first_of("0123456789") != 0) return Done{};
             return bad_index_line(line, "is no pair of vertex numbers",
                                   "Write two numbers a line: source,target");
           }));
  return pairs;
}

}  // namespace mien
