#include "mien/io/vl.h"

#include <cmath>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr std::size_t kVertexBytes = 12;

}  // namespace

Result<std::vector<Vec3>> read_vl(std::span<const std::byte> bytes) {
  const auto bad = [](std::string why) { return Error{Errc::input, ".vl frame", std::move(why), ""}; };
  const auto count = read_le<std::uint32_t>(bytes, 0);
  if (!count) return bad("it has " + std::to_string(bytes.size()) + " bytes, expected at least 4");
  const auto size = checked_multiply(*count, kVertexBytes);
  if (!size || *size != bytes.size() - 4)
    return bad("it announces " + std::to_string(*count) + " vertices and holds " +
               std::to_string(bytes.size() - 4) + " bytes of them, expected 12 each");
  std::vector<Vec3> positions(*count);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const std::size_t at = 4 + v * kVertexBytes;
    const Vec3 p{*read_le<float>(bytes, at), *read_le<float>(bytes, at + 4), *read_le<float>(bytes, at + 8)};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return bad("vertex " + std::to_string(v) + " is not finite");
    positions[v] = p;
  }
  return positions;
}

Bytes write_vl(std::span<const Vec3> positions) {
  contract(positions.size() <= 0xffffffffu, "write_vl: too many vertices");
  Bytes bytes;
  bytes.reserve(4 + positions.size() * kVertexBytes);
  append_le(bytes, static_cast<std::uint32_t>(positions.size()));
  for (const Vec3& p : positions)
    for (const float x : {p.x, p.y, p.z}) append_le(bytes, x);
  return bytes;
}

}  // namespace mien
