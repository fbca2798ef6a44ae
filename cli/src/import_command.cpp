// mien import: other people's checkpoints as one model file.
#include <chrono>

#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/models/import/import_model.h"
#include "options.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  ImportOptions options;
  std::vector<std::string> sources;
  std::string output, encoder, templates, scaler, subjects;
};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

Status check_output(const ImportArguments& a, const ImportOptions& options) {
  const fs::path output = a.output;
  if (output.extension() != ".safetensors")
    return Error{Errc::usage, "output '" + a.output + "'", "has no name of a model file",
                 "Choose a name that ends in .safetensors"};
  std::vector<fs::path> inputs = options.sources;
  inputs.insert(inputs.end(), {options.encoder, options.templates, options.scaler});
  std::error_code ec;
  for (const auto& input : inputs)
    for (const fs::path& file : {input, input / "model.safetensors"})
      if (fs::equivalent(output, file, ec))
        return Error{Errc::usage, "output '" + a.output + "'", "is an input of this command",
                     "Choose another name"};
  MIEN_TRY([[maybe_unused]] const auto probe, AtomicFile::create(output));
  return Done{};
}

Status run_import(const ImportArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  ImportOptions options = a.options;
  for (const auto& source : a.sources) options.sources.emplace_back(source);
  options.encoder = a.encoder, options.templates = a.templates, options.scaler = a.scaler;
  if (!a.subjects.empty()) options.subjects = split(a.subjects);
  progress.event("start", "\"command\":\"import\",\"input\":" + json_string(a.sources.front()) +
                              ",\"outputs\":[" + json_string(a.output) + "]");
  MIEN_TRY([[maybe_unused]] const auto writable, check_output(a, options));
  const auto imported = import_model(options, a.output, progress);
  if (!imported) return imported.error();
  for (const auto& warning : imported.warnings) progress.warn(warning);
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string system(architecture_name(imported->description.architecture));
  progress.event("success", "\"outputs\":[" + json_string(a.output) +
                                "],\"architecture\":" + json_string(system) +
                                ",\"tensors\":" + std::to_string(imported->num_tensors) + ",\"parameters\":" +
                                std::to_string(imported->num_parameters) + ",\"seconds\":" + fixed(taken, 3));
  progress.say("wrote " + a.output + ": " + system + " with " + std::to_string(imported->num_parameters) +
               " parameters in " + fixed(taken, 2) + " s");
  return Done{};
}

}  // namespace

void add_import_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("import", "Turn other people's checkpoints into a model file");
  auto a = std::make_shared<ImportArguments>();
  command
      ->add_option("SOURCE", a->sources,
                   "Hugging Face folder, .safetensors, .bin, .pth, .pt or .ckpt; behind it, in any order, "
                   "templates.pkl, a scaler's .pkl, region .txt files and the encoder's folder")
      ->required();
  command->add_option("-o,--output", a->output, "Model file (.safetensors)")->required();
  command->add_option("--encoder", a->encoder,
                      "Hugging Face folder (or config.json) of the speech encoder: its sizes, and its "
                      "weights where SOURCE has none");
  command->add_option("--templates", a->templates, "Neutral faces by subject: templates.pkl");
  command->add_option("--scaler", a->scaler, "Scaler of the rig's controls, for FaceDiffuser B-DAMM: .pkl");
  command->add_option("--region", a->options.regions,
                      "Region of the mesh: lve.txt, fdd.txt or NAME=FILE. May be repeated");
  command->add_option(
      "--system", a->options.system,
      "What SOURCE is, when it shall not be told by its tensors: speech_encoder, "
      "facexhubert, facediffuser_v, facediffuser_beat, facediffuser_damm, facediffuser_emotion, "
      "probtalk3d, probtalk3d_prior, said or said_vae");
  command
      ->add_option("--heads", a->options.heads,
                   "Attention heads of ProbTalk3D, where the checkpoint does not say. Default: 8")
      ->check(CLI::Range(1, 1024));
  command->add_option("--subjects", a->subjects, "Names of the training subjects, in order: F2,F3,F4");
  command->add_option("--fps", a->options.fps, "Frames a second of the motion, where the mesh does not tell")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--steps", a->options.steps, "Diffusion steps of B-DAMM's training. Default: 1000")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--schedule", a->options.schedule, "Noise of the training: cosine or linear")
      ->check(CLI::IsMember({"cosine", "linear"}))
      ->capture_default_str();
  command->add_flag("--half", a->options.half, "Store weights in half precision: half the size");
  add_console_options(*command, chosen);
  add_footer(*command,
             "  mien import hubert-base-ls960/ -o hubert.safetensors\n"
             "  mien import pretrained_BIWI.pth templates.pkl -o biwi.safetensors\n"
             "  mien import pretrained_DAMM.pth --scaler scaler.pkl --half -o damm.safetensors\n"
             "  mien import SAiD.pth -o said.safetensors\n"
             "  mien import last.ckpt -o probtalk3d.safetensors\n");
  command->callback(
      [a, &chosen] { chosen.work = [a](ConsoleProgress& progress) { return run_import(*a, progress); }; });
}

}  // namespace mien
