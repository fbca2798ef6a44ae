#include "mien/datasets/blendshape_residuals.h"

#include <algorithm>
#include <cmath>

#include "mien/io/pickle.h"

namespace mien {
namespace {

// A dictionary with text for keys, entry by entry.
template <class Each>
Status for_each_entry(const PickleValue& dict, const std::string& name, Each&& each) {
  if (dict.kind() != PickleKind::dict)
    return Error{Errc::incompatible, name, "is not a dictionary by name",
                 "Expected is person -> shape -> array [vertices, 3]"};
  if (dict.size() == 0) return Error{Errc::incompatible, name, "is empty", ""};
  for (std::size_t i = 0; i < dict.size(); ++i) {
    const auto key = dict.key(i).text();
    if (!key)
      return Error{Errc::incompatible, name, "entry " + std::to_string(i) + " has no name",
                   "Expected is person -> shape -> array [vertices, 3]"};
    // Files are named after persons.
    if (key->empty() || key->front() == '.' || key->find('/') != std::string_view::npos)
      return Error{Errc::incompatible, name, "the name '" + std::string(*key) + "' is no name of a file", ""};
    MIEN_TRY([[maybe_unused]] const auto done, each(std::string(*key), dict[i]));
  }
  return Done{};
}

Result<std::vector<float>> offsets_of(const PickleValue& value, const std::string& name) {
  const PickleArray* array = value.array();
  if (array == nullptr || array->shape.size() != 2 || array->shape[1] != 3 || array->shape[0] == 0)
    return Error{Errc::incompatible, name, "is not an array [vertices, 3]", ""};
  auto offsets = array->to_floats();
  if (!offsets) return within(offsets.error(), name);
  if (!std::ranges::all_of(*offsets, [](float v) { return std::isfinite(v); }))
    return Error{Errc::incompatible, name, "has numbers that are not finite", ""};
  return offsets;
}

}  // namespace

Result<std::map<std::string, ShapeResiduals>> load_blendshape_residuals(const std::filesystem::path& path) {
  MIEN_TRY(const Pickle pickle, Pickle::open(path));
  const std::string file = "'" + path.string() + "'";
  std::map<std::string, ShapeResiduals> persons;
  std::size_t size = 0;
  const auto add_person = [&](const std::string& person, const PickleValue& shapes) {
    return for_each_entry(shapes, file + " '" + person + "'",
                          [&](const std::string& shape, const PickleValue& value) -> Status {
                            const std::string name = file + " '" + person + "' '" + shape + "'";
                            MIEN_TRY(auto offsets, offsets_of(value, name));
                            if (size == 0) size = offsets.size();
                            if (offsets.size() != size)
                              return Error{Errc::incompatible, name,
                                           "moves " + std::to_string(offsets.size() / 3) +
                                               " vertices, the first shape " + std::to_string(size / 3),
                                           ""};
                            persons[person][shape] = std::move(offsets);
                            return Done{};
                          });
  };
  MIEN_TRY([[maybe_unused]] const auto read, for_each_entry(pickle.root(), file, add_person));
  return persons;
}

}  // namespace mien
