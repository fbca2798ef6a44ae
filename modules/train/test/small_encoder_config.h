#pragma once
#include "mien/models/speech_encoder/encoder_config.h"

namespace mien {

/// A HuBERT of width 16 that learns in seconds.
inline EncoderConfig small_encoder_config(std::int64_t num_layers) {
  EncoderConfig c;
  c.hidden_size = 16;
  c.num_hidden_layers = num_layers;
  c.num_attention_heads = 2;
  c.intermediate_size = 24;
  c.conv_dim.assign(7, 8);
  c.num_conv_pos_embeddings = 8;
  c.num_conv_pos_embedding_groups = 4;
  return c;
}

}  // namespace mien
