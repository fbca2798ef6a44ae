#include "animate_plan.h"

#include <algorithm>
#include <array>
#include <map>

#include "character_source.h"
#include "mien/core/emotion.h"
#include "mien/core/flame_parameters.h"
#include "mien/face/flame.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/safetensors.h"
#include "mien/models/face_model.h"
#include "share.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kName = "{name}";

// The architecture decides what the words mean and what is written.
Result<ModelFile> describe(const fs::path& path) {
  const auto file = SafetensorsFile::open(path);
  if (!file) return file.error();
  auto model = read_model_file(file->metadata());
  if (!model) return within(model.error(), "loading model '" + path.string() + "'");
  return model;
}

Status direct(const AnimateArguments& a, const ModelFile& model, AnimatePlan& p) {
  using System = AnimatePlan::System;
  if (p.system != System::standard) {
    MIEN_TRY([[maybe_unused]] const auto precision, encoder_precision(a.face));
  }
  if (p.system == System::said) {
    auto options = said_options(a.words, a.face, a.said, trained_steps(model));
    if (!options) return options.error();
    p.said = *options;
    Status status = Done{};
    status.warnings = options.warnings;
    return status;
  }
  if (const std::string word = a.said.used(); !word.empty())
    return Error{Errc::usage, word, "does not apply to this model: it is for SAiD",
                 "Leave it out, or name such a model with --model"};
  if (p.system == System::face) {
    MIEN_TRY([[maybe_unused]] const auto checked, check_words(a.face, model));
    MIEN_TRY(p.face, face_options(a.words, a.face, model));
    return Done{};
  }
  if (const std::string word = a.face.used(); !word.empty())
    return Error{Errc::usage, word, "does not apply to this model: it is for the published systems",
                 "Leave it out, or name such a model with --model"};
  MIEN_TRY(p.options, perform_options(a.words));
  return Done{};
}

// The mesh whose vertices the model moves; outputs that cannot be made of it are refused before the work.
Status plan_mesh(const AnimateArguments& a, const ModelFile& model, AnimatePlan& p) {
  const auto mesh = vertex_mesh(a.vertices, vertex_motion(topology_of(model.output.channels / 3), 1));
  if (!mesh) return mesh.error();
  Status status = Done{};
  for (const auto& output : p.all_outputs()) {
    const auto extension = output.path.extension();
    if (extension == ".csv" || extension == ".json")
      return Error{Errc::usage, "output '" + output.path.string() + "'",
                   "cannot hold the vertices that this model moves", "Write .npy, .glb, meshes or pictures"};
    if (output.is_picture() && mesh->triangles.empty())
      return Error{Errc::usage, "output '" + output.path.string() + "'", "a picture needs triangles",
                   "Pass --mesh FILE with the template of the data set (.obj or .ply)"};
    if (output.is_glb()) status.warnings = mesh.warnings;
  }
  p.mesh = *mesh;
  return status;
}

// The face that --face names moves in the mesh's place, in all outputs.
Status plan_other_face(AnimatePlan& p) {
  if (p.vertices.face.empty()) return Done{};
  if (!p.mesh)
    return Error{Errc::usage, "--face", "is for models that move vertices, and for --flame",
                 "Pass a face with shapes as --character instead"};
  MIEN_TRY(p.other_face, other_face(p.vertices, *p.mesh));
  if (p.flame_face == FlameFace::none)
    for (ClipPlan& clip : p.clips)
      for (Output& output : clip.outputs) output.is_derived = true;
  return Done{};
}

// A model that gives FLAME parameters, and the FLAME model that makes a face of them, if there is one.
Status plan_flame(const AnimateArguments& a, const ModelFile& model, AnimatePlan& p) {
  if (model.output.space != "flame") {
    if (a.flame.empty() && a.flame_rig.empty()) return Done{};
    return Error{Errc::usage, a.flame.empty() ? "--flame-rig" : "--flame",
                 "is for models that give FLAME parameters", "Leave it out"};
  }
  if (a.flame.empty() && !(a.flame_rig.empty() && a.character.empty()))
    return Error{Errc::usage, a.flame_rig.empty() ? "--character" : "--flame-rig",
                 "needs a FLAME model: this model gives FLAME parameters",
                 "Pass --flame generic_model.pkl too"};
  if (a.flame.empty()) {
    p.num_flame_parameters = model.output.channels;
    return Done{};
  }
  MIEN_TRY(FlameModel flame, read_flame_model(a.flame));
  const auto needed = model.output.channels - static_cast<std::int64_t>(kNumFlameJaw);
  const auto given = flame.num_shapes - static_cast<std::int64_t>(kNumFlameShape);
  if (given < needed)
    return Error{Errc::incompatible, "'" + a.flame + "'",
                 "has " + std::to_string(given) + " expressions, the model moves " + std::to_string(needed),
                 "Pass the FLAME model that goes with the data, such as FLAME 2020"};
  // A character that is named is to move, so it needs coefficients.
  const std::string& rig = a.flame_rig.empty() ? a.character : a.flame_rig;
  if (!rig.empty()) {
    p.flame_face = FlameFace::rig;
    MIEN_TRY(Character character, load_character(rig));
    if (a.flame_rig.empty() && merged_mesh(character).positions.size() != flame.neutral.size() / 3)
      return Error{
          Errc::incompatible, "--character '" + rig + "'",
          "has another topology than the FLAME model: no coefficients can be fitted on it",
          "Pass a face of FLAME's topology with ARKit shapes too: --flame-rig flame_rig.glb (made by "
          "mien transfer " +
              a.flame + ")"};
    MIEN_TRY(p.flame_rig,
             FlameRig::create(std::move(flame), std::move(character), rig, {.threads = a.threads}));
    return Done{};
  }
  p.flame_face = FlameFace::vertices;
  p.flame = std::move(flame);
  p.mesh = flame_mesh(*p.flame);
  if (p.vertices.mm_per_unit == 0) p.vertices.mm_per_unit = kFlameMmPerUnit;
  return Done{};
}

std::string named(std::string pattern, const std::string& name) {
  for (std::size_t at = pattern.find(kName); at != std::string::npos; at = pattern.find(kName, at)) {
    pattern.replace(at, kName.size(), name);
    at += name.size();
  }
  return pattern;
}

// Names of outputs with {name} in them. Folders for all recordings join p.folders.
Result<std::vector<std::string>> output_patterns(const AnimateArguments& a, const std::string& extension,
                                                 AnimatePlan& p) {
  if (a.outputs.empty()) return std::vector<std::string>{std::string(kName) + extension};
  if (a.speech.size() == 1) return a.outputs;
  std::vector<std::string> patterns;
  for (const std::string& name : a.outputs) {
    std::error_code ec;
    if (name.find(kName) != std::string::npos) {
      patterns.push_back(name);
    } else if (name.ends_with('/') || fs::is_directory(name, ec)) {
      p.folders.emplace_back(name);
      patterns.push_back((fs::path(name) / (std::string(kName) + extension)).string());
    } else {
      return Error{Errc::usage, "output '" + name + "'", "would be written by every recording",
                   "Put {name} in it, such as '{name}" + fs::path(name).extension().string() +
                       "', or name a folder: 'folder/'"};
    }
  }
  return patterns;
}

// Recordings of one name would overwrite each other's outputs.
Status check_apart(const std::vector<ClipPlan>& clips) {
  std::map<fs::path, fs::path> writers;
  for (const ClipPlan& clip : clips)
    for (const Output& output : clip.outputs) {
      std::error_code ec;
      const auto [at, is_new] =
          writers.emplace(fs::weakly_canonical(fs::absolute(output.path, ec), ec), clip.speech);
      if (!is_new)
        return Error{
            Errc::usage, "output '" + output.path.string() + "'",
            "would be written by '" + at->second.string() + "' and by '" + clip.speech.string() + "'",
            "Give the recordings different names, or animate them one after the other"};
    }
  return Done{};
}

Status plan_clips(const AnimateArguments& a, bool moves_vertices, AnimatePlan& p) {
  const bool is_flame = p.flame_face != FlameFace::none || p.num_flame_parameters > 0;
  const bool moves_character = p.flame_face == FlameFace::rig || !(moves_vertices || is_flame);
  MIEN_TRY(const auto patterns, output_patterns(a, moves_character ? ".glb" : ".npy", p));
  constexpr OutputKind kAll[] = {OutputKind::motion, OutputKind::video, OutputKind::sheet, OutputKind::frames,
                                 OutputKind::meshes};
  const std::span<const OutputKind> kinds = std::span(kAll).first(moves_vertices || p.flame ? 5 : 4);
  std::vector<fs::path> inputs(a.speech.begin(), a.speech.end());
  for (const fs::path& other :
       {p.model_path, p.character_path, fs::path(a.vertices.mesh), fs::path(a.said.init), fs::path(a.flame),
        fs::path(a.flame_rig), fs::path(a.vertices.face)})
    inputs.push_back(other);
  for (const std::string& speech : a.speech) {
    std::vector<std::string> names;
    for (const std::string& pattern : patterns)
      names.push_back(named(pattern, fs::path(speech).stem().string()));
    MIEN_TRY(auto outputs, plan_outputs(names, inputs, kinds, a.takes));
    if (is_flame) {
      MIEN_TRY([[maybe_unused]] const auto fit, plan_flame_outputs(outputs, p.flame_face));
    }
    p.clips.push_back({speech, std::move(outputs)});
  }
  return check_apart(p.clips);
}

}  // namespace

std::span<const Output> ClipPlan::of_take(int take, int num_takes) const {
  const std::size_t per_take = outputs.size() / static_cast<std::size_t>(num_takes);
  return std::span(outputs).subspan(static_cast<std::size_t>(take) * per_take, per_take);
}

std::vector<Output> AnimatePlan::all_outputs() const {
  std::vector<Output> all;
  for (const ClipPlan& clip : clips) all.insert(all.end(), clip.outputs.begin(), clip.outputs.end());
  return all;
}

Result<ModelFile> plan_performer(const AnimateArguments& a, AnimatePlan& p) {
  ModelFile model;
  if (a.model.empty()) {
    MIEN_TRY(p.model_path, shared_file("default.safetensors", "--model FILE"));
  } else {
    p.model_path = a.model;
    MIEN_TRY(model, describe(a.model));
    if (FaceModel::runs(model.architecture)) p.system = AnimatePlan::System::face;
    if (model.architecture == Architecture::said) p.system = AnimatePlan::System::said;
  }
  const Status directed = direct(a, model, p);
  if (!directed) return directed.error();
  Result<ModelFile> result(std::move(model));
  result.warnings = directed.warnings;
  return result;
}

Result<AnimatePlan> plan_animation(const AnimateArguments& a) {
  AnimatePlan p;
  const auto planned = plan_performer(a, p);
  if (!planned) return planned.error();
  const ModelFile& model = *planned;
  const bool moves_vertices = model.output.space == "vertices";
  if (!a.vertices.mesh.empty() && !moves_vertices)
    return Error{Errc::usage, "--mesh", "is for models that move vertices",
                 "Leave it out, or pass a face with --character"};
  p.vertices = a.vertices;
  MIEN_TRY([[maybe_unused]] const auto flame, plan_flame(a, model, p));
  const auto size = parse_size(a.size);
  if (!size) return size.error();
  p.pictures = {.width = size->first, .height = size->second, .threads = a.threads};
  if (a.fps > 0) p.pictures.fps = a.fps;
  if (!a.times.empty()) {
    MIEN_TRY(p.pictures.times, parse_times(a.times));
  }
  p.pictures.columns = a.columns;
  MIEN_TRY([[maybe_unused]] const auto view, check_view(a.view));
  p.pictures.view = a.view;
  MIEN_TRY(p.character_path, character_path(a.character));
  MIEN_TRY([[maybe_unused]] const auto clips, plan_clips(a, moves_vertices, p));
  Status mesh = Done{};
  if (moves_vertices) mesh = plan_mesh(a, model, p);
  if (!mesh) return mesh.error();
  MIEN_TRY([[maybe_unused]] const auto face, plan_other_face(p));
  Result<AnimatePlan> plan(std::move(p));
  plan.warnings = planned.warnings;
  plan.warnings.insert(plan.warnings.end(), mesh.warnings.begin(), mesh.warnings.end());
  return plan;
}

Result<std::vector<std::string>> planned_emotions(const AnimateArguments& a, const AnimatePlan& p) {
  std::vector<std::string> emotions, known;
  if (a.emotions.empty()) return emotions;
  const auto refusal = [](std::string what, std::string why, std::string fix) {
    return Error{Errc::usage, std::move(what), std::move(why), std::move(fix)};
  };
  if (!a.words.emotion.empty())
    return refusal("--emotion", "is one, --emotions are several", "Pass one of them");
  if (a.speech.size() > 1) return refusal("--emotions", "are shown of one recording", "Pass one SPEECH");
  if (a.takes > 1) return refusal("--emotions", "are shown in one take each", "Leave --takes out");
  for (const Output& output : p.clips.front().outputs)
    if (!output.is_picture())
      return refusal("output '" + output.path.string() + "'", "holds one emotion; --emotions shows several",
                     "Write .png, .mp4, .webm or a folder/ of pictures, or use --emotion");
  if (p.system == AnimatePlan::System::standard) {
    known.assign(emotion_names().begin(), emotion_names().end());
  } else {
    MIEN_TRY(const ModelFile model, describe(a.model));
    known = model.emotions;
  }
  if (known.empty())
    return refusal("--emotions", "mean nothing to this model: it knows none", "Leave it out");
  if (a.emotions == "all" || a.emotions.starts_with("all:")) {
    for (const std::string& name : known)
      emotions.push_back(name == "neutral" ? name : name + a.emotions.substr(3));
    return emotions;
  }
  for (std::size_t at = 0; at <= a.emotions.size();) {
    const std::size_t end = std::min(a.emotions.find(',', at), a.emotions.size());
    emotions.push_back(a.emotions.substr(at, end - at));
    const std::string name = emotions.back().substr(0, emotions.back().find(':'));
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string list;
      for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
      return refusal("--emotions '" + a.emotions + "'", "'" + name + "' is not one of the model's",
                     "Known: all, " + list);
    }
    at = end + 1;
  }
  return emotions;
}

Status plan_emotion(const AnimateArguments& a, const std::string& emotion, AnimatePlan& p) {
  AnimateArguments other = a;
  other.words.emotion = emotion;
  const auto planned = plan_performer(other, p);
  if (!planned) return planned.error();
  Status status = Done{};
  status.warnings = planned.warnings;
  return status;
}

Status prepare_outputs(AnimatePlan& p, ConsoleProgress& progress) {
  for (const fs::path& folder : p.folders) {
    std::error_code ec;
    fs::create_directories(folder, ec);
    if (ec) return Error{Errc::failed, "'" + folder.string() + "'", "cannot be made: " + ec.message(), ""};
  }
  const std::vector<Output> outputs = p.all_outputs();
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable(outputs));
  if (p.mesh) return Done{};
  const auto any = [&](auto wanted) { return std::any_of(outputs.begin(), outputs.end(), wanted); };
  if (any([](const Output& o) { return o.is_glb(); })) {
    MIEN_TRY(p.character_glb, character_glb(p.character_path));
  }
  if (any([](const Output& o) { return o.is_picture(); })) {
    auto character = load_character(p.character_path);
    if (!character) return character.error();
    for (const auto& warning : character.warnings) progress.warn(warning);
    p.character = std::move(*character);
  }
  return Done{};
}

}  // namespace mien
