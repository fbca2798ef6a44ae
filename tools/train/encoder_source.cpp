#include "encoder_source.h"

#include "mien/models/model_file.h"
#include "mien/train/encoder_training.h"

namespace mien::train {

Status EncoderSource::load_into(SpeechEncoder<torch::Tensor>& encoder) const {
  if (!file) return Done{};
  const auto loaded = load_encoder(encoder, *file);
  if (!loaded) return within(loaded.error(), name);
  return Done{};
}

Result<EncoderSource> open_encoder(const EncoderChoice& choice, bool spec_augment) {
  if (choice.fresh) return EncoderSource{std::nullopt, *choice.fresh, "the new encoder"};
  MIEN_TRY(auto file, SafetensorsFile::open(choice.file));
  std::string name = "'" + choice.file.string() + "'";
  const auto source = read_model_file(file.metadata());
  if (!source) return within(source.error(), name);
  if (!source->encoder)
    return Error{Errc::incompatible, name, "holds no speech encoder",
                 "Make one: mien import HUBERT-FOLDER, or a folder of wav2vec 2.0"};
  if (spec_augment && source->encoder->mask_feature_prob > 0)
    return Error{Errc::incompatible, name, "masks features in training, which Mien does not",
                 "Set [random] spec_augment = false"};
  return EncoderSource{std::move(file), *source->encoder, std::move(name)};
}

}  // namespace mien::train
