#pragma once
#include <map>
#include <string>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/nn/layers.h"

namespace mien::facexhubert {

struct Sizes {
  std::int64_t input = 1536;  ///< two speech features side by side
  std::int64_t hidden = 256;
  std::int64_t num_layers = 2;
  std::int64_t num_subjects = 14;
  std::int64_t num_emotions = 2;
  std::int64_t num_channels = 70110;  ///< D = 3 vertices
};

/// Read from the shapes of the stored tensors. Errors (Errc::incompatible): not such weights.
Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes);
Result<Sizes> sizes_of(const SafetensorsFile& file);

/// FaceXHuBERT behind its speech encoder: a GRU over pairs of features whose states are scaled by the subject
/// and the emotion, then one linear map to the vertices.
template <class T>
struct Network {
  Sizes sizes;
  Gru<T> gru{sizes.input, sizes.hidden, sizes.num_layers};
  WeightedEmbedding<T> subject{sizes.num_subjects, sizes.hidden};
  WeightedEmbedding<T> emotion{sizes.num_emotions, sizes.hidden};
  Linear<T> out{sizes.hidden, sizes.num_channels, Init::zero};

  explicit Network(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("gru", gru);
    v.scope("obj_vector", subject);
    v.scope("emo_vector", emotion);
    v.scope("fc", out);
  }

  /// aligned features [.., N, 2 H]; weights of subjects [.., 1, S] and emotions [.., 1, E] (one-hot as
  /// published); neutral [.., 1, D] -> absolute positions [.., N, D].
  /// With `past` (empty at the start) the clip may come in pieces.
  T operator()(const T& features, const T& subject_weights, const T& emotion_weights, const T& neutral,
               std::vector<T>* past = nullptr) const {
    return decode(past != nullptr ? gru(features, *past) : gru(features), subject_weights, emotion_weights,
                  neutral);
  }
  /// What follows the GRU, whose states are `h` [.., N, G]: training drops some between its layers.
  T decode(const T& h, const T& subject_weights, const T& emotion_weights, const T& neutral) const {
    using B = Operations<T>;
    return B::add(out(B::mul(B::mul(h, subject(subject_weights)), emotion(emotion_weights))), neutral);
  }
};

}  // namespace mien::facexhubert
