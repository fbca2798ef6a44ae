#include "prepared_entry.h"

#include <cstring>

namespace mien {
namespace {

template <class T>
void append_vector(Bytes& bytes, const std::vector<T>& values) {
  append_le(bytes, static_cast<std::uint64_t>(values.size()));
  const auto* p = reinterpret_cast<const std::byte*>(values.data());
  bytes.insert(bytes.end(), p, p + values.size() * sizeof(T));
}

// Reads what append_* wrote; `ok` falls to false at the first read past the end and stays there.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  template <class T>
  T value() {
    const auto v = read_le<T>(bytes_, at_);
    ok_ = ok_ && v.has_value();
    if (!ok_) return T{};
    at_ += sizeof(T);
    return *v;
  }
  template <class T>
  void vector(std::vector<T>& out) {
    const auto count = value<std::uint64_t>();
    ok_ = ok_ && count <= (bytes_.size() - at_) / sizeof(T);
    if (!ok_) return;
    out.resize(count);
    if (count > 0) std::memcpy(out.data(), bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace

void append_entry(Bytes& bytes, const PreparedEntry& e) {
  append_vector(bytes, e.mel);
  append_vector(bytes, e.level);
  append_vector(bytes, e.viseme);
  append_vector(bytes, e.closure);
  append_vector(bytes, e.accent);
  append_le(bytes, static_cast<std::uint32_t>(e.takes.size()));
  for (const auto& take : e.takes) {
    append_le(bytes, take.style);
    for (const float z : take.latents) append_le(bytes, z);
    append_vector(bytes, take.curves);
    append_vector(bytes, take.blink);
    append_vector(bytes, take.raise);
  }
  append_le(bytes, e.emotion);
  append_le(bytes, e.intensity);
  append_le(bytes, e.split);
  append_le(bytes, e.seconds);
}

Result<std::vector<PreparedEntry>> parse_entries(std::span<const std::byte> bytes) {
  std::vector<PreparedEntry> entries;
  Reader in(bytes);
  while (in.ok() && !in.at_end()) {
    PreparedEntry e;
    in.vector(e.mel);
    in.vector(e.level);
    in.vector(e.viseme);
    in.vector(e.closure);
    in.vector(e.accent);
    const auto takes = in.value<std::uint32_t>();
    for (std::uint32_t k = 0; k < takes && in.ok(); ++k) {
      PreparedTake take;
      take.style = in.value<std::uint8_t>();
      for (float& z : take.latents) z = in.value<float>();
      in.vector(take.curves);
      in.vector(take.blink);
      in.vector(take.raise);
      e.takes.push_back(std::move(take));
    }
    e.emotion = in.value<std::uint8_t>();
    e.intensity = in.value<float>();
    e.split = in.value<std::uint8_t>();
    e.seconds = in.value<double>();
    if (in.ok()) entries.push_back(std::move(e));
  }
  if (!in.ok()) return Error{Errc::failed, "prepared entries", "the bytes end too early", ""};
  return entries;
}

}  // namespace mien
