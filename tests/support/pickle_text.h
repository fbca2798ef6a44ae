#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Python's pickles, protocol 2 and below, as the makers of VOCASET wrote them. A whole pickle ends with ".".
namespace mien::pickle_text {

inline std::string text(std::string_view t) {
  return "U" + std::string(1, static_cast<char>(t.size())) + std::string(t);
}
inline std::string number(std::int64_t n) { return "I" + std::to_string(n) + "\n"; }
inline std::string dict(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string all = "}";
  for (const auto& [key, value] : entries) all += key + value + "s";
  return all;
}
/// @param type  NumPy's name of T: "f4", "f8", "i2"; @param shape  empty: one axis
template <class T>
std::string array(const std::vector<T>& values, const char* type, std::vector<std::size_t> shape = {}) {
  std::string data(values.size() * sizeof(T), '\0'), length(4, '\0');
  std::memcpy(data.data(), values.data(), data.size());
  const auto size = static_cast<std::uint32_t>(data.size());
  std::memcpy(length.data(), &size, sizeof size);
  if (shape.empty()) shape = {values.size()};
  std::string axes;
  for (const std::size_t count : shape) axes += "I" + std::to_string(count) + "\n";
  return "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(" + axes +
         "tcnumpy\ndtype\n(S'" + type + "'\nI0\nI1\ntR(I3\nS'<'\nNNNI-1\nI-1\nI0\ntbI0\nT" + length + data +
         "tb";
}

}  // namespace mien::pickle_text
