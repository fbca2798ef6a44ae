#include "imported_tensor.h"

#include <map>

#include "mien/tensor/tensor.h"

namespace mien {

Result<std::vector<ImportedTensor>> matching_tensors(const std::vector<ListParameters::Entry>& wanted,
                                                     const std::vector<ImportedTensor>& found,
                                                     const std::string& prefix, const std::string& file) {
  std::map<std::string_view, const ImportedTensor*> by_name;
  for (const auto& tensor : found) by_name.emplace(tensor.name, &tensor);
  std::vector<ImportedTensor> matching;
  std::vector<std::string> warnings;
  std::string problems;
  const auto complain = [&](const std::string& what) { problems += (problems.empty() ? "" : "; ") + what; };
  for (const auto& entry : wanted) {
    const auto place = by_name.find(entry.name);
    if (place == by_name.end() && entry.is_optional)
      warnings.push_back("no tensor '" + prefix + entry.name + "', which only training needs");
    else if (place == by_name.end())
      complain("no tensor '" + prefix + entry.name + "'");
    else if (place->second->shape != entry.shape)
      complain("tensor '" + place->second->source + "' has shape " + shape_text(place->second->shape) +
               ", expected " + shape_text(entry.shape));
    else
      matching.push_back(*place->second);
  }
  if (!problems.empty()) {
    constexpr std::size_t kMostText = 600;
    if (const auto end = problems.find(';', kMostText); end != problems.npos)
      problems = problems.substr(0, end) + " ...";
    return Error{Errc::incompatible, file, "does not fit the configuration: " + problems,
                 "Check that the configuration belongs to the weights, and that the file is whole"};
  }
  Result<std::vector<ImportedTensor>> result(std::move(matching));
  result.warnings = std::move(warnings);
  return result;
}

}  // namespace mien
