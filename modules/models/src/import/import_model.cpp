#include "mien/models/import/import_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "encoder_weights.h"
#include "mien/core/topology.h"
#include "mien/io/min_max_scaler.h"
#include "mien/models/said/said_model.h"
#include "probtalk3d_description.h"
#include "side_files.h"
#include "system_subjects.h"
#include "system_weights.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr float kMostHalf = 65504;
// Feature extractors normalised with 1e-5 up to version 4.10 of the library, which the HuBERT systems pinned,
// and with 1e-7 from 4.11 on, which SAiD used for wav2vec 2.0.
constexpr double kOldNormaliseEps = 1e-5, kNewNormaliseEps = 1e-7;

constexpr std::int64_t kSaidShapes = 32;  // coefficients as published; others have no names

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// What goes into the model file: tensors by the weights that hold them.
struct Plan {
  ModelFile description;
  std::vector<ImportedTensor> tensors;          ///< of the first source
  std::vector<ImportedTensor> encoder_tensors;  ///< of the encoder's own weights, when they are elsewhere
  Templates templates;
  std::vector<Region> regions;
  std::vector<std::string> warnings;
};

void keep_warnings(std::vector<std::string>& all, const std::vector<std::string>& more) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(more.size(), kMost); ++i) all.push_back(more[i]);
  if (more.size() > kMost)
    all.push_back("and " + std::to_string(more.size() - kMost) + " more like the last");
}

// Sorts the sources behind the first into the options for which they stand.
Result<ImportOptions> sorted_sources(ImportOptions options) {
  const auto twice = [](const fs::path& path, const char* option) {
    return Error{Errc::usage, quoted(path), std::string("is a second file for ") + option, ""};
  };
  for (std::size_t i = 1; i < options.sources.size(); ++i) {
    const fs::path& path = options.sources[i];
    std::error_code ec;
    if (path.extension() == ".txt") {
      options.regions.push_back(path.string());
    } else if (fs::is_directory(path, ec) || path.filename() == "config.json") {
      if (!options.encoder.empty()) return twice(path, "--encoder");
      options.encoder = path;
    } else if (path.extension() == ".pkl") {
      MIEN_TRY(const auto pickle, Pickle::open(path, {.keep_foreign = true}));
      fs::path& slot = is_min_max_scaler(pickle.root()) ? options.scaler : options.templates;
      if (!slot.empty()) return twice(path, is_min_max_scaler(pickle.root()) ? "--scaler" : "--templates");
      slot = path;
    } else {
      return Error{Errc::usage, quoted(path), "is a second model: one is imported at a time",
                   "Behind the first may stand an encoder's folder, .pkl files and region .txt files"};
    }
  }
  options.sources.resize(1);
  return options;
}

Result<EncoderConfig> encoder_config(const ImportOptions& options, const FoundEncoder& encoder,
                                     Architecture architecture) {
  std::error_code ec;
  fs::path place = options.encoder;
  if (place.empty())
    place = fs::is_directory(options.sources[0], ec) ? options.sources[0] : options.sources[0].parent_path();
  if (place.empty()) place = ".";
  // A config.json beside a system's checkpoint may be anything; beside an encoder it is the encoder's.
  const bool look = !options.encoder.empty() || architecture == Architecture::speech_encoder;
  std::optional<EncoderConfig> config;
  if (look) {
    MIEN_TRY(config, read_encoder_config(place));
  }
  if (!config) {
    auto told = encoder_config_from_shapes(encoder.shapes());
    if (!told)
      return Error{told.error().code, quoted(options.sources[0]) + ": " + told.error().what, told.error().why,
                   "Give the folder with the encoder's config.json: --encoder FOLDER"};
    config = std::move(*told);
  }
  if (architecture == Architecture::said) config->model_type = "wav2vec2";
  const bool is_new = architecture == Architecture::said || architecture == Architecture::speech_encoder;
  config->normalise_eps = is_new && config->model_type == "wav2vec2" ? kNewNormaliseEps : kOldNormaliseEps;
  return *config;
}

double known_fps(Architecture architecture, std::int64_t channels) {
  if (architecture == Architecture::facexhubert || architecture == Architecture::facediffuser_emotion)
    return 25;
  if (architecture == Architecture::said) return 60;
  if (architecture != Architecture::facediffuser_v) return 30;
  const auto topology = known_topology(channels / 3);
  return topology ? topology->fps : 0;
}

Status describe_motion(const ImportOptions& options, const SystemFacts& facts, const WeightsSource& weights,
                       Plan& plan) {
  ModelFile& m = plan.description;
  if (is_probtalk3d(m.architecture)) {
    const Status described = describe_probtalk3d(options, facts, weights, m);
    keep_warnings(plan.warnings, described.warnings);
    return described;
  }
  const bool vertices = m.architecture == Architecture::facexhubert ||
                        m.architecture == Architecture::facediffuser_v ||
                        m.architecture == Architecture::facediffuser_emotion;
  m.output.space = vertices                                            ? "vertices"
                   : m.architecture == Architecture::facediffuser_beat ? "arkit"
                                                                       : "rig";
  if (m.architecture == Architecture::said) m.output.space = facts.channels == kSaidShapes ? "arkit" : "rig";
  m.output.channels = facts.channels;
  if (vertices && facts.channels % 3 != 0)
    return Error{Errc::incompatible, quoted(options.sources[0]),
                 "moves " + std::to_string(facts.channels) + " coordinates, which is no number of vertices",
                 ""};
  if (vertices) m.output.topology = topology_of(facts.channels / 3).name;
  m.output.fps = options.fps.value_or(known_fps(m.architecture, facts.channels));
  if (m.architecture == Architecture::said && m.output.fps != 60)
    return Error{Errc::usage, "--fps", "is always 60 for SAiD: its frames are tied to the speech", ""};
  if (!(m.output.fps > 0))
    return Error{Errc::usage, "--fps",
                 "is needed: the frame rate of a mesh with " + std::to_string(facts.channels / 3) +
                     " vertices is not known",
                 "BIWI has 25 frames a second, VOCASET and Multiface have 30"};
  if (m.architecture == Architecture::facexhubert) {
    m.emotions = {"neutral", "expressive"};
    if (options.steps)
      return Error{Errc::usage, "--steps", "does not apply: FaceXHuBERT has no diffusion", ""};
  } else {
    m.diffusion = ModelDiffusion{options.schedule, options.steps.value_or(1000)};
    if (facts.num_steps > 0) {
      if (options.steps && *options.steps != facts.num_steps)
        return Error{Errc::usage, "--steps",
                     "is " + std::to_string(*options.steps) + ", but the weights were trained with " +
                         std::to_string(facts.num_steps) + " steps",
                     "Leave --steps out"};
      m.diffusion->steps = facts.num_steps;
    }
  }
  const double per_frame = std::max(1.0, std::ceil(50 / m.output.fps));
  if (facts.condition != static_cast<std::int64_t>(per_frame) * m.encoder->hidden_size)
    return Error{Errc::incompatible, quoted(options.sources[0]),
                 "takes " + std::to_string(facts.condition) + " speech features a frame, the encoder gives " +
                     std::to_string(static_cast<std::int64_t>(per_frame) * m.encoder->hidden_size),
                 "Check --fps and the encoder's configuration"};
  if (m.architecture == Architecture::facediffuser_emotion) {
    const Status named = name_style_columns(options, weights, facts.num_styles, m);
    keep_warnings(plan.warnings, named.warnings);
    return named;
  }
  auto subjects = subject_names(options.subjects, facts.num_subjects, m.architecture, m.output.topology);
  if (!subjects) return subjects.error();
  keep_warnings(plan.warnings, subjects.warnings);
  m.subjects = std::move(*subjects);
  return Done{};
}

Status add_side_files(const ImportOptions& options, Plan& plan) {
  const ModelFile& m = plan.description;
  const bool vertices = m.output.space == "vertices";
  if (!vertices && (!options.templates.empty() || !options.regions.empty()))
    return Error{Errc::usage, options.templates.empty() ? "--region" : "--templates",
                 "does not apply: the model does not move vertices", ""};
  if (m.architecture != Architecture::facediffuser_damm && !options.scaler.empty())
    return Error{Errc::usage, "--scaler", "does not apply: only FaceDiffuser B-DAMM is scaled", ""};
  if (!options.templates.empty()) {
    MIEN_TRY(plan.templates, read_templates(options.templates, m.output.channels));
  } else if (vertices) {
    plan.warnings.emplace_back("no neutral faces were given (--templates): the model cannot be run without");
  }
  if (!options.scaler.empty()) {
    MIEN_TRY(MinMaxScaler scaler, read_min_max_scaler(options.scaler, m.output.channels));
    plan.description.scaler = ModelScaler{std::move(scaler.scale), std::move(scaler.min)};
  } else if (m.architecture == Architecture::facediffuser_damm) {
    plan.warnings.emplace_back("no scaler was given (--scaler): controls stay within -1 ... 1");
  }
  for (const auto& argument : options.regions) {
    MIEN_TRY(auto region, read_region(argument, m.output.channels / 3));
    for (const auto& other : plan.regions)
      if (other.name == region.name)
        return Error{Errc::usage, "--region", "'" + region.name + "' is given twice", ""};
    plan.regions.push_back(std::move(region));
  }
  return Done{};
}

// SAiD's motion codec: no speech, no subjects, no diffusion.
Status plan_motion_codec(const ImportOptions& options, const FoundSystem& system, Plan& plan) {
  const std::string file = quoted(options.sources[0]);
  if (!options.templates.empty() || !options.scaler.empty() || !options.regions.empty() ||
      !options.subjects.empty() || !options.encoder.empty() || options.steps)
    return Error{Errc::usage, file, "is a motion codec: options of an animation model do not apply", ""};
  auto facts = system_facts(system, file, 0);
  if (!facts) return facts.error();
  keep_warnings(plan.warnings, facts.warnings);
  plan.tensors = std::move(facts->tensors);
  plan.description.output.space = "arkit";
  plan.description.output.channels = facts->channels;
  plan.description.output.fps = options.fps.value_or(kSaidFps);
  return Done{};
}

Status plan_encoder(const ImportOptions& options, const std::optional<FoundEncoder>& encoder, bool is_own,
                    Plan& plan) {
  const std::string file = quoted(options.sources[0]);
  if (!encoder)
    return Error{Errc::incompatible, file, "holds no speech encoder",
                 "Name the Hugging Face folder that it was trained with: --encoder FOLDER"};
  ModelFile& m = plan.description;
  MIEN_TRY(m.encoder, encoder_config(options, *encoder, m.architecture));
  auto tensors = encoder_tensors(*encoder, *m.encoder, is_own ? file : quoted(options.encoder));
  if (!tensors) return tensors.error();
  keep_warnings(plan.warnings, tensors.warnings);
  for (auto& tensor : *tensors) tensor.name = std::string(ModelFile::kEncoderPrefix) + tensor.name;
  (is_own ? plan.tensors : plan.encoder_tensors) = std::move(*tensors);
  return Done{};
}

Result<Plan> make_plan(const ImportOptions& options, const WeightsSource& weights,
                       const std::optional<FoundEncoder>& own, const WeightsSource* encoder_weights) {
  const std::string file = quoted(options.sources[0]);
  Plan plan;
  ModelFile& m = plan.description;
  MIEN_TRY(const auto system, find_system(weights, own, options.system, file));
  m.architecture = system.architecture;
  const fs::path& source = options.sources[0];  // a folder may be given with a slash at its end
  m.source = (source.has_filename() ? source : source.parent_path()).filename().string();
  m.name = fs::path(m.source).stem().string();
  m.licence = "that of the imported weights";
  if (m.architecture == Architecture::said_vae) {
    MIEN_TRY([[maybe_unused]] const auto planned, plan_motion_codec(options, system, plan));
    return plan;
  }

  std::optional<FoundEncoder> other;
  if (!own && encoder_weights != nullptr) {
    MIEN_TRY(other, find_encoder(*encoder_weights, quoted(options.encoder)));
  }
  if (m.architecture == Architecture::probtalk3d_prior) {
    if (own || other)
      return Error{Errc::usage, file, "is a motion prior, which hears nothing", "Leave --encoder out"};
  } else {
    MIEN_TRY([[maybe_unused]] const auto heard,
             plan_encoder(options, own ? own : other, own.has_value(), plan));
  }
  if (m.architecture == Architecture::speech_encoder) {
    std::set<std::string_view> used;
    for (const auto& tensor : plan.tensors) used.insert(tensor.source);
    if (const auto rest = weights.tensors().size() - used.size(); own && rest > 0)
      plan.warnings.push_back("left out what is not the encoder's: " + std::to_string(rest) +
                              (rest == 1 ? " tensor" : " tensors"));
    if (!options.templates.empty() || !options.scaler.empty() || !options.regions.empty() ||
        !options.subjects.empty() || options.steps || options.fps)
      return Error{Errc::usage, file, "is a speech encoder alone: options of an animation model do not apply",
                   ""};
    return plan;
  }
  auto heads = probtalk3d_heads(options, weights, m.architecture);
  if (!heads) return heads.error();
  keep_warnings(plan.warnings, heads.warnings);
  if (is_probtalk3d(m.architecture)) m.sizes["heads"] = *heads;
  auto facts = system_facts(system, file, *heads);
  if (!facts) return facts.error();
  keep_warnings(plan.warnings, facts.warnings);
  plan.tensors.insert(plan.tensors.end(), facts->tensors.begin(), facts->tensors.end());
  MIEN_TRY([[maybe_unused]] const auto described, describe_motion(options, *facts, weights, plan));
  MIEN_TRY([[maybe_unused]] const auto added, add_side_files(options, plan));
  return plan;
}

// The length of each tap of a positional convolution [O, I, K], over all channels together.
std::vector<float> tap_lengths(const std::vector<float>& weight, std::size_t taps) {
  std::vector<double> squares(taps, 0.0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    squares[i % taps] += static_cast<double>(weight[i]) * static_cast<double>(weight[i]);
  std::vector<float> lengths(taps);
  for (std::size_t k = 0; k < taps; ++k) lengths[k] = static_cast<float>(std::sqrt(squares[k]));
  return lengths;
}

Status copy_tensors(const WeightsSource& weights, const std::vector<ImportedTensor>& tensors, bool half,
                    const std::string& file, SafetensorsWriter& writer, Progress& progress,
                    std::int64_t& done) {
  for (const auto& tensor : tensors) {
    if (progress.cancelled()) return Error{Errc::cancelled, "import", "was interrupted", ""};
    MIEN_TRY(auto values, weights.read(tensor.source));
    const float most = half ? kMostHalf : std::numeric_limits<float>::max();
    for (const float v : values)
      if (!(std::abs(v) <= most))
        return Error{Errc::incompatible, file + ": tensor '" + tensor.source + "'",
                     std::isfinite(v) ? "holds " + std::to_string(v) + ", too large for half precision"
                                      : "holds values that are not finite",
                     std::isfinite(v) ? "Leave --half out" : "The file may be damaged"};
    if (tensor.how == ImportedTensor::How::tap_lengths)
      values = tap_lengths(values, static_cast<std::size_t>(tensor.shape.back()));
    MIEN_TRY([[maybe_unused]] const auto written, writer.write_float(tensor.name, values));
    progress.update(done += static_cast<std::int64_t>(values.size()));
  }
  return Done{};
}

}  // namespace

Result<ImportedModel> import_model(const ImportOptions& given, const fs::path& output, Progress& progress) {
  contract(!given.sources.empty(), "import_model: no source");
  contract(given.schedule == "cosine" || given.schedule == "linear", "import_model: schedule");
  MIEN_TRY(const auto options, sorted_sources(given));
  MIEN_TRY(const auto weights, open_weights(options.sources[0]));
  MIEN_TRY(const auto own, find_encoder(*weights, quoted(options.sources[0])));
  std::unique_ptr<WeightsSource> encoder_weights;
  if (std::error_code ec; !own && fs::is_directory(options.encoder, ec)) {
    MIEN_TRY(encoder_weights, open_weights(options.encoder));
  }
  MIEN_TRY(const Plan plan, make_plan(options, *weights, own, encoder_weights.get()));

  ImportedModel imported{.description = plan.description};
  std::vector<StoredTensor> stored;
  const auto declare = [&](std::string name, Dtype dtype, Shape shape) {
    stored.push_back({std::move(name), dtype, std::move(shape)});
    return stored.back().count();
  };
  for (const auto* tensors : {&plan.tensors, &plan.encoder_tensors})
    for (const auto& tensor : *tensors)
      imported.num_parameters += declare(tensor.name, options.half ? Dtype::f16 : Dtype::f32, tensor.shape);
  for (const auto& [subject, values] : plan.templates)
    declare(std::string(ModelFile::kTemplatePrefix) + subject, Dtype::f32,
            {static_cast<std::int64_t>(values.size())});
  for (const auto& region : plan.regions)
    declare(std::string(ModelFile::kRegionPrefix) + region.name, Dtype::i64,
            {static_cast<std::int64_t>(region.vertices.size())});
  imported.num_tensors = static_cast<std::int64_t>(stored.size());

  MIEN_TRY(auto writer, SafetensorsWriter::create(output, std::move(stored), to_metadata(plan.description)));
  progress.stage("importing", imported.num_parameters);
  std::int64_t done = 0;
  MIEN_TRY(
      [[maybe_unused]] const auto copied,
      copy_tensors(*weights, plan.tensors, options.half, quoted(options.sources[0]), writer, progress, done));
  if (encoder_weights != nullptr) {
    MIEN_TRY([[maybe_unused]] const auto encoder_copied,
             copy_tensors(*encoder_weights, plan.encoder_tensors, options.half, quoted(options.encoder),
                          writer, progress, done));
  }
  for (const auto& [subject, values] : plan.templates) {
    MIEN_TRY([[maybe_unused]] const auto written,
             writer.write(std::string(ModelFile::kTemplatePrefix) + subject, values));
  }
  for (const auto& region : plan.regions) {
    MIEN_TRY([[maybe_unused]] const auto written,
             writer.write(std::string(ModelFile::kRegionPrefix) + region.name, region.vertices));
  }
  MIEN_TRY([[maybe_unused]] const auto finished, writer.finish());
  Result<ImportedModel> result(std::move(imported));
  result.warnings = plan.warnings;
  return result;
}

}  // namespace mien
