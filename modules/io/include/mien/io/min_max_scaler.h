#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "mien/io/pickle.h"

namespace mien {

/// Range of a data set by channel, as scikit-learn's MinMaxScaler stores it: y = scale x + min.
struct MinMaxScaler {
  std::vector<double> scale, min;
};

/// True when the root of a pickle is one.
bool is_min_max_scaler(const PickleValue& root);

/// scale_ and min_ of a pickled MinMaxScaler. Errors: as Pickle::open(); (Errc::incompatible): something else
/// inside, another number of channels, or a channel without inverse.
Result<MinMaxScaler> read_min_max_scaler(const std::filesystem::path& path, std::int64_t channels);

}  // namespace mien
