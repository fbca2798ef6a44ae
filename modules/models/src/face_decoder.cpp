#include "mien/models/face_decoder.h"

#include <array>

namespace mien {
namespace {

constexpr std::array<std::string_view, 4> kKinds = {"gru", "rnn", "lstm", "transformer"};

std::int64_t size_of(const std::map<std::string, Shape>& shapes, const std::string& name, std::size_t axis) {
  const auto stored = shapes.find(name);
  return stored != shapes.end() && stored->second.size() == 2 ? stored->second[axis] : 0;
}

std::int64_t count_layers(const std::map<std::string, Shape>& shapes, const std::string& start,
                          const std::string& end) {
  std::int64_t count = 0;
  while (shapes.contains(start + std::to_string(count) + end)) ++count;
  return count;
}

}  // namespace

std::optional<DecoderKind> parse_decoder_kind(std::string_view name) {
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    if (kKinds[i] == name) return static_cast<DecoderKind>(i);
  return std::nullopt;
}

std::string_view decoder_kind_name(DecoderKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::optional<StoredDecoder> stored_decoder(const std::map<std::string, Shape>& shapes) {
  StoredDecoder found;
  if (const std::int64_t layers = count_layers(shapes, "transformer.layers.", ".linear1.weight")) {
    found.scope = "transformer";
    found.sizes.kind = DecoderKind::transformer;
    found.sizes.num_layers = layers;
    found.input = size_of(shapes, "transformer.memory_map.weight", 1);
    found.hidden = size_of(shapes, "transformer.memory_map.weight", 0);
    return found;
  }
  for (const char* scope : {"gru", "rnn", "lstm"}) {
    const std::string start = std::string(scope) + ".weight_";
    found.sizes.num_layers = count_layers(shapes, start + "ih_l", "");
    if (found.sizes.num_layers == 0) continue;
    found.scope = scope;
    found.input = size_of(shapes, start + "ih_l0", 1);
    found.hidden = size_of(shapes, start + "hh_l0", 1);
    // The published name of B-DAMM's GRU is "rnn": gates tell the kinds apart.
    const std::int64_t rows = size_of(shapes, start + "hh_l0", 0);
    found.sizes.kind = rows == 4 * found.hidden   ? DecoderKind::lstm
                       : rows == 3 * found.hidden ? DecoderKind::gru
                                                  : DecoderKind::rnn;
    return found;
  }
  return std::nullopt;
}

}  // namespace mien
