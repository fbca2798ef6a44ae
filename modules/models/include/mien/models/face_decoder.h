#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mien/base/contract.h"
#include "mien/nn/recurrent.h"
#include "mien/nn/transformer.h"

namespace mien {

// The decoder between the tokens of a frame and the last layer of FaceXHuBERT and FaceDiffuser: the GRU of
// the published models, or one of those that the papers compare it with (FaceXHuBERT, table 1; FaceDiffuser,
// table 5). docs/training.md says what the papers leave open.

enum class DecoderKind { gru, rnn, lstm, transformer };
std::optional<DecoderKind> parse_decoder_kind(std::string_view name);  ///< "gru", "rnn" ...
std::string_view decoder_kind_name(DecoderKind kind);

struct DecoderSizes {
  DecoderKind kind = DecoderKind::gru;
  std::int64_t num_layers = 2;
  std::int64_t heads = 4;  ///< of a transformer; not to be read from shapes
};

/// What names and shapes of stored tensors tell of a decoder.
struct StoredDecoder {
  DecoderSizes sizes;
  std::string scope;  ///< what its parameters' names begin with
  std::int64_t input = 0, hidden = 0;
};
/// nothing when there is none. A transformer's number of heads is left as it is by default.
std::optional<StoredDecoder> stored_decoder(const std::map<std::string, Shape>& shapes);

/// What training does inside a decoder; nothing, when it runs.
template <class T>
struct DecoderPass {
  std::function<T(T)> drop{};  ///< between recurrent layers, or inside a transformer's
  /// Teacher forcing: a transformer reads these rows [.., N, feedback] as what it wrote. Without, its own.
  const T* written = nullptr;
};

template <class T>
struct FaceDecoder {
  using Network = std::variant<Gru<T>, Rnn<T>, Lstm<T>, TransformerDecoder<T>>;
  DecoderSizes sizes;
  Network network;

  /// @param input  tokens of a frame;  feedback  numbers that the last layer gives
  FaceDecoder(const DecoderSizes& s, std::int64_t input, std::int64_t hidden, std::int64_t feedback)
      : sizes(s), network(make(s, input, hidden, feedback)) {}

  /// Parameters lie below the scope that the published GRU has, or below the kind of any other.
  template <class V>
  void visit_as(std::string_view published_scope, V& v) {
    v.scope(sizes.kind == DecoderKind::gru ? published_scope : decoder_kind_name(sizes.kind), *this);
  }
  template <class V>
  void visit(V& v) {
    std::visit([&](auto& n) { n.visit(v); }, network);
  }

  [[nodiscard]] bool is_recurrent() const { return sizes.kind != DecoderKind::transformer; }
  /// @pre of this kind
  [[nodiscard]] const Gru<T>& gru() const {
    contract(sizes.kind == DecoderKind::gru, "the decoder is no GRU");
    return std::get<Gru<T>>(network);
  }

  /// tokens [.., N, input] -> [.., N, hidden]. With `past` (empty at the start) a sequence may come in
  /// pieces.
  /// @pre is_recurrent()
  T states(const T& tokens, std::vector<T>* past = nullptr, const DecoderPass<T>& pass = {}) const {
    std::vector<T> start;
    const auto between = [&](T h) { return pass.drop ? pass.drop(std::move(h)) : h; };
    return std::visit(
        [&](const auto& n) -> T {
          if constexpr (std::is_same_v<std::decay_t<decltype(n)>, TransformerDecoder<T>>) {
            contract(false, "a transformer has no states without what it wrote");
            return tokens;
          } else {
            return n(tokens, past != nullptr ? *past : start, between);
          }
        },
        network);
  }

  /// All frames. `write` is the last layer: states [.., n, hidden] -> rows [.., n, feedback]. A transformer
  /// writes frame by frame, each from those before, and looks at the tokens of the whole clip.
  template <class Write>
  T operator()(const T& tokens, Write&& write, const DecoderPass<T>& pass = {}) const {
    using B = Operations<T>;
    if (is_recurrent()) return write(states(tokens, nullptr, pass));
    const auto& transformer = std::get<TransformerDecoder<T>>(network);
    auto state = transformer.begin(tokens);
    const std::int64_t count = B::num_rows(tokens);
    T previous = B::zero_rows(tokens, count == 0 ? 0 : 1, transformer.feedback);
    if (count == 0) return previous;
    if (pass.written != nullptr)
      return write(transformer.next(B::concat_rows({previous, B::rows(*pass.written, 0, count - 1)}), state,
                                    pass.drop));
    std::vector<T> out;
    for (std::int64_t n = 0; n < count; ++n) {
      previous = write(transformer.next(previous, state, pass.drop));
      out.push_back(previous);
    }
    return B::concat_rows(out);
  }

 private:
  static Network make(const DecoderSizes& s, std::int64_t input, std::int64_t hidden, std::int64_t feedback) {
    switch (s.kind) {
      case DecoderKind::rnn:
        return Rnn<T>(input, hidden, s.num_layers);
      case DecoderKind::lstm:
        return Lstm<T>(input, hidden, s.num_layers);
      case DecoderKind::transformer:
        return TransformerDecoder<T>(input, feedback, hidden, s.num_layers, s.heads);
      case DecoderKind::gru:
        break;
    }
    return Gru<T>(input, hidden, s.num_layers);
  }
};

}  // namespace mien
