#include "side_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "mien/base/file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostSubjects = 10'000;

Error misfit(const fs::path& path, std::string why) {
  return {Errc::incompatible, "'" + path.string() + "'", std::move(why), ""};
}

// Numbers of a text, whatever stands between them. Nothing when there is something else.
std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(", \t\r\n", at)) != text.npos) {
    const std::size_t end = std::min(text.find_first_of(", \t\r\n", at), text.size());
    double number = 0;
    const auto [stop, problem] = std::from_chars(text.data() + at, text.data() + end, number);
    if (problem != std::errc() || stop != text.data() + end || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    at = end;
  }
  return numbers;
}

}  // namespace

Result<Templates> read_templates(const fs::path& path, std::int64_t channels) {
  MIEN_TRY(const auto pickle, Pickle::open(path));
  const auto root = pickle.root();
  if (root.kind() != PickleKind::dict || root.size() == 0 || root.size() > kMostSubjects)
    return misfit(path, "holds no neutral faces: expected a dictionary from subjects to arrays [V, 3]");
  Templates templates;
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < root.size(); ++i) {
    const auto subject = root.key(i).text();
    const auto* array = root[i].array();
    if (!subject || subject->empty() || array == nullptr || !names.insert(*subject).second)
      return misfit(path, "holds an entry that is no neutral face: expected arrays [V, 3] by subject");
    if (array->count() != channels)
      return misfit(path, "has a neutral face of '" + std::string(*subject) + "' with " +
                              std::to_string(array->count()) + " coordinates, the model has " +
                              std::to_string(channels));
    auto values = array->to_floats();
    if (!values) return within(values.error(), "'" + path.string() + "': '" + std::string(*subject) + "'");
    if (!std::ranges::all_of(*values, [](float v) { return std::isfinite(v); }))
      return misfit(path, "has a neutral face of '" + std::string(*subject) + "' that is not finite");
    templates.emplace_back(std::string(*subject), std::move(*values));
  }
  return templates;
}

Result<Region> read_region(const std::string& argument, std::int64_t num_vertices) {
  const auto equals = argument.find('=');
  const fs::path path = equals == argument.npos ? argument : argument.substr(equals + 1);
  const std::string stem = path.stem().string();
  Region region;
  region.name = equals != argument.npos ? argument.substr(0, equals)
                : stem == "lve"         ? "mouth"
                : stem == "fdd"         ? "upper"
                                        : stem;
  if (region.name.empty()) return Error{Errc::usage, "region '" + argument + "'", "has no name", ""};
  MIEN_TRY(const auto text, read_file(path));
  const auto numbers = numbers_in(as_text(text));
  if (!numbers || numbers->empty())
    return misfit(path, "lists no vertices: expected numbers with commas or line ends between them");
  const bool are_weights = static_cast<std::int64_t>(numbers->size()) == num_vertices &&
                           std::ranges::all_of(*numbers, [](double w) { return w >= 0 && w <= 1; });
  const double limit = stem.find("forehead") != stem.npos ? 0.4 : 0.1;
  std::set<std::int64_t> vertices;
  for (std::size_t i = 0; i < numbers->size(); ++i) {
    const double number = (*numbers)[i];
    if (are_weights) {
      if (number > limit) vertices.insert(static_cast<std::int64_t>(i));
      continue;
    }
    if (number < 0 || number >= static_cast<double>(num_vertices) || number != std::floor(number))
      return misfit(path, "names vertex " + std::to_string(number) + " of a mesh with " +
                              std::to_string(num_vertices) + " vertices");
    vertices.insert(static_cast<std::int64_t>(number));
  }
  region.vertices.assign(vertices.begin(), vertices.end());
  return region;
}

}  // namespace mien
