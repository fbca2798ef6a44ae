#pragma once
#include <map>
#include <string>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/models/face_decoder.h"
#include "mien/nn/layers.h"

namespace mien::facexhubert {

struct Sizes {
  std::int64_t input = 1536;  ///< two speech features side by side
  std::int64_t hidden = 256;
  DecoderSizes decoder = {};
  std::int64_t num_subjects = 14;
  std::int64_t num_emotions = 2;
  std::int64_t num_channels = 70110;  ///< D = 3 vertices
};

/// Read from the shapes of the stored tensors. Errors (Errc::incompatible): not such weights.
Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes);
Result<Sizes> sizes_of(const SafetensorsFile& file);

/// FaceXHuBERT behind its speech encoder: a GRU over pairs of features (or another decoder) whose states are
/// scaled by the subject and the emotion, then one linear map to the vertices.
template <class T>
struct Network {
  Sizes sizes;
  FaceDecoder<T> decoder{sizes.decoder, sizes.input, sizes.hidden, sizes.num_channels};
  WeightedEmbedding<T> subject{sizes.num_subjects, sizes.hidden};
  WeightedEmbedding<T> emotion{sizes.num_emotions, sizes.hidden};
  Linear<T> out{sizes.hidden, sizes.num_channels, Init::zero};

  explicit Network(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    decoder.visit_as("gru", v);
    v.scope("obj_vector", subject);
    v.scope("emo_vector", emotion);
    v.scope("fc", out);
  }

  /// aligned features [.., N, 2 H]; weights of subjects [.., 1, S] and emotions [.., 1, E] (one-hot as
  /// published); neutral [.., 1, D] -> absolute positions [.., N, D].
  /// With `past` (empty at the start) the clip may come in pieces. @pre no past, or decoder.is_recurrent()
  T operator()(const T& features, const T& subject_weights, const T& emotion_weights, const T& neutral,
               std::vector<T>* past = nullptr, const DecoderPass<T>& pass = {}) const {
    using B = Operations<T>;
    const T style = subject(subject_weights), manner = emotion(emotion_weights);
    const auto offsets = [&](const T& h) { return out(B::mul(B::mul(h, style), manner)); };
    return B::add(
        past != nullptr ? offsets(decoder.states(features, past, pass)) : decoder(features, offsets, pass),
        neutral);
  }
};

}  // namespace mien::facexhubert
