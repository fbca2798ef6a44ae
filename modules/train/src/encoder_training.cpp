#include "mien/train/encoder_training.h"

#include "mien/models/model_file.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {

Status load_encoder(SpeechEncoder<torch::Tensor>& encoder, const SafetensorsFile& file) {
  Collect list;
  list.scope("audio_encoder", encoder);
  std::erase_if(list.entries, [&](const Collect::Entry& e) {
    return e.name.ends_with("masked_spec_embed") && file.find(e.name) == nullptr;
  });
  return load_parameters(list.entries, file, ModelFile::kEncoderPrefix);
}

}  // namespace mien::train
