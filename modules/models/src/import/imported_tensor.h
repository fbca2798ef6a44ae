#pragma once
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "parameter_list.h"

namespace mien {

/// One tensor of the model file and where it comes from.
struct ImportedTensor {
  enum class How {
    copy,
    tap_lengths,  ///< of a folded positional convolution: the length of each kernel tap, [1, 1, K]
  };
  std::string name;  ///< in the model file
  Shape shape;
  std::string source;  ///< in the weights
  How how = How::copy;
};

/// Of `found` what a network with the parameters `wanted` needs, in its order. @param prefix  of the names in
/// `file`, for messages. Errors (Errc::incompatible) naming every missing tensor and wrong shape; a missing
/// optional one only warns.
Result<std::vector<ImportedTensor>> matching_tensors(const std::vector<ListParameters::Entry>& wanted,
                                                     const std::vector<ImportedTensor>& found,
                                                     const std::string& prefix, const std::string& file);

}  // namespace mien
