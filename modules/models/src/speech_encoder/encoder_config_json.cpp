#include <nlohmann/json.hpp>

#include "mien/models/speech_encoder/encoder_config.h"
#include "refusal.h"

namespace mien {
namespace {

using Json = nlohmann::ordered_json;

/// Reads fields one by one and keeps the first complaint.
class Fields {
 public:
  explicit Fields(const Json& json) : json_(json) {}

  void read(const char* field, std::int64_t& value) {
    read_as(field, value, "a whole number", [](const Json& j) { return j.is_number_integer(); });
  }
  void read(const char* field, double& value) {
    read_as(field, value, "a number", [](const Json& j) { return j.is_number(); });
  }
  void read(const char* field, bool& value) {
    read_as(field, value, "true or false", [](const Json& j) { return j.is_boolean(); });
  }
  void read(const char* field, std::string& value) {
    read_as(field, value, "a text", [](const Json& j) { return j.is_string(); });
  }
  void read(const char* field, std::vector<std::int64_t>& value) {
    read_as(field, value, "a list of whole numbers", [](const Json& j) {
      return j.is_array() && j.size() <= 64 &&
             std::all_of(j.begin(), j.end(), [](const Json& e) { return e.is_number_integer(); });
    });
  }
  /// The field may be absent, null, false or one of `allowed`; everything else is refused with the reason.
  void refuse_unless(const char* field, std::initializer_list<Json> allowed, const char* why) {
    const auto found = json_.find(field);
    if (found == json_.end() || found->is_null()) return;
    for (const auto& value : allowed)
      if (*found == value) return;
    complain(field, std::string(why) + " (it is " + found->dump() + ")");
  }
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  template <class T, class Fits>
  void read_as(const char* field, T& value, const char* expected, Fits&& fits) {
    const auto found = json_.find(field);
    if (found == json_.end() || found->is_null()) return;
    if (!fits(*found)) return complain(field, "is " + found->dump().substr(0, 60) + ", expected " + expected);
    value = found->get<T>();
  }
  void complain(const char* field, const std::string& why) {
    if (status_) status_ = encoder_refusal(field, why);
  }
  const Json& json_;
  Status status_ = Done{};
};

Result<Json> parse_object(std::string_view text, const char* what) {
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object())
    return Error{Errc::incompatible, what, "is not a JSON object", "The file may be damaged"};
  return json;
}

/// Each field that is read as it is stored, under its name.
template <class Config, class Use>
void for_each_field(Config& c, Use&& use) {
  use("model_type", c.model_type);
  use("hidden_size", c.hidden_size);
  use("num_hidden_layers", c.num_hidden_layers);
  use("num_attention_heads", c.num_attention_heads);
  use("intermediate_size", c.intermediate_size);
  use("conv_dim", c.conv_dim);
  use("conv_kernel", c.conv_kernel);
  use("conv_stride", c.conv_stride);
  use("conv_bias", c.conv_bias);
  use("num_conv_pos_embeddings", c.num_conv_pos_embeddings);
  use("num_conv_pos_embedding_groups", c.num_conv_pos_embedding_groups);
  use("do_stable_layer_norm", c.do_stable_layer_norm);
  use("feat_proj_layer_norm", c.feat_proj_layer_norm);
  use("layer_norm_eps", c.layer_norm_eps);
  use("apply_spec_augment", c.apply_spec_augment);
  use("mask_time_prob", c.mask_time_prob);
  use("mask_time_length", c.mask_time_length);
  use("mask_time_min_masks", c.mask_time_min_masks);
  use("mask_feature_prob", c.mask_feature_prob);
  use("mask_feature_length", c.mask_feature_length);
  use("mask_feature_min_masks", c.mask_feature_min_masks);
  use("hidden_dropout", c.hidden_dropout);
  use("activation_dropout", c.activation_dropout);
  use("attention_dropout", c.attention_dropout);
  use("feat_proj_dropout", c.feat_proj_dropout);
  use("layerdrop", c.layerdrop);
  use("do_normalize", c.do_normalize);
  use("normalise_eps", c.normalise_eps);
}

}  // namespace

Result<EncoderConfig> encoder_config_from_json(std::string_view text) {
  MIEN_TRY(const Json json, parse_object(text, "encoder configuration"));
  EncoderConfig c;
  Fields fields(json);
  fields.refuse_unless("model_type", {"hubert", "wav2vec2"},
                       "must be hubert or wav2vec2: other networks differ");
  fields.refuse_unless("conv_pos_batch_norm", {false},
                       "batch norm at the positional convolution is not supported");
  fields.refuse_unless("add_adapter", {false}, "adapters are not supported");
  fields.refuse_unless("adapter_attn_dim", {}, "adapters are not supported");
  fields.refuse_unless("hidden_act", {"gelu"}, "must be gelu");
  fields.refuse_unless("feat_extract_activation", {"gelu"}, "must be gelu");
  fields.refuse_unless("feat_extract_norm", {"group", "layer"}, "must be group or layer");
  for_each_field(c, [&](const char* name, auto& value) { fields.read(name, value); });
  if (!fields.status()) return fields.status().error();
  c.conv_layer_norm = json.value("feat_extract_norm", Json("group")) == "layer";
  MIEN_TRY([[maybe_unused]] const auto valid, c.validate());
  return c;
}

Status read_preprocessor_config(std::string_view text, EncoderConfig& config) {
  MIEN_TRY(const Json json, parse_object(text, "preprocessor configuration"));
  Fields fields(json);
  std::int64_t rate = 16000, channels = 1;
  fields.read("do_normalize", config.do_normalize);
  fields.read("sampling_rate", rate);
  fields.read("feature_size", channels);
  if (!fields.status()) return fields.status().error();
  if (rate != 16000)
    return encoder_refusal("sampling_rate", "is " + std::to_string(rate) + ", expected 16000");
  if (channels != 1)
    return encoder_refusal("feature_size", "is " + std::to_string(channels) + ", expected 1");
  return Done{};
}

std::string to_json(const EncoderConfig& config) {
  Json json;
  for_each_field(config, [&](const char* name, const auto& value) { json[name] = value; });
  json["feat_extract_norm"] = config.conv_layer_norm ? "layer" : "group";
  return json.dump();
}

}  // namespace mien
