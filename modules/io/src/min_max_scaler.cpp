#include "mien/io/min_max_scaler.h"

#include <cmath>

namespace mien {

bool is_min_max_scaler(const PickleValue& root) { return root.class_name().ends_with(".MinMaxScaler"); }

Result<MinMaxScaler> read_min_max_scaler(const std::filesystem::path& path, std::int64_t channels) {
  const auto misfit = [&](std::string why) {
    return Error{Errc::incompatible, "'" + path.string() + "'", std::move(why), ""};
  };
  MIEN_TRY(const auto pickle, Pickle::open(path, {.keep_foreign = true}));
  const auto root = pickle.root();
  if (!is_min_max_scaler(root))
    return misfit(root.class_name().empty() ? "holds no MinMaxScaler of scikit-learn"
                                            : "holds an object of '" + std::string(root.class_name()) +
                                                  "', expected a MinMaxScaler of scikit-learn");
  const auto read = [&](const char* member) -> Result<std::vector<double>> {
    const auto value = root.state() ? root.state()->find(member) : std::nullopt;
    const auto* array = value ? value->array() : nullptr;
    if (array == nullptr || array->count() != channels)
      return misfit(std::string("has no ") + member + " of " + std::to_string(channels) +
                    " numbers, one per channel");
    return array->to_doubles();
  };
  MinMaxScaler scaler;
  MIEN_TRY(scaler.scale, read("scale_"));
  MIEN_TRY(scaler.min, read("min_"));
  for (std::size_t c = 0; c < scaler.scale.size(); ++c)
    if (!std::isfinite(scaler.min[c]) || !std::isfinite(scaler.scale[c]) || scaler.scale[c] == 0)
      return misfit("has no inverse at channel " + std::to_string(c));
  return scaler;
}

}  // namespace mien
