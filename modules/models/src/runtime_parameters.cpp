#include "mien/models/runtime_parameters.h"

#include <algorithm>
#include <cmath>

namespace mien {

std::vector<float> LoadRuntime::read(std::string_view name, const Shape& shape) {
  const std::string full = prefix_ + full_name(name);
  const auto complain = [&](const std::string& what) { problems_ += (problems_.empty() ? "" : "; ") + what; };
  used_.insert(full);
  std::int64_t count = 1;
  for (const auto size : shape) count *= size;
  if (const auto found = file_.expect(full, shape); !found) {
    complain(found.error().message());
  } else if (auto values = file_.read_float(full); !values) {
    complain(values.error().message());
  } else if (const bool finite =
                 std::all_of(values->begin(), values->end(), [](float v) { return std::isfinite(v); });
             !finite) {
    complain("tensor '" + full + "' holds values that are not finite");
  } else {
    return std::move(*values);
  }
  return std::vector<float>(static_cast<std::size_t>(count));
}

void LoadRuntime::matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
  slot = PackedMatrix(read(name, {out, in}), out, in);
}

void LoadRuntime::convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                              std::int64_t kernel, Init) {
  slot = PackedMatrix(tap_major(Tensor({out, in, kernel}, read(name, {out, in, kernel}))));
}

void LoadRuntime::tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
  slot = Tensor(shape, read(name, shape));
}

Status LoadRuntime::finish() const {
  std::string problems = problems_;
  for (const auto& stored : file_.tensors())
    if (stored.name.starts_with(prefix_) && !used_.contains(stored.name) &&
        std::none_of(left_out_.begin(), left_out_.end(),
                     [&](const std::string& prefix) { return stored.name.starts_with(prefix); }))
      problems += (problems.empty() ? "" : "; ") + ("unknown tensor '" + stored.name + "'");
  if (problems.empty()) return Done{};
  return Error{Errc::incompatible, "weights", problems,
               "The file may be damaged or of another configuration"};
}

}  // namespace mien
